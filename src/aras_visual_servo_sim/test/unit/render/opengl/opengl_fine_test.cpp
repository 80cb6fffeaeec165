// Images of OpenGL before they are rounded to bytes: what a noisy sensor gets.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "light_tools.hpp"

namespace aras_visual_servo_sim::testing::opengl_fine_test {
namespace {

constexpr double kUnits = kUnitsOf<std::uint16_t>;

FineImage renderFine(const CameraModel& camera, const Pose& X_WC, const Scene& scene) {
  FineImage image;
  sharedOpenGl().render(camera, X_WC, scene, image);
  return image;
}

TEST(OpenGlFine, LightIsThatOfTheFormulaBetweenGreyLevels) {
  Light bulb = lamp(Light::Type::kPoint, 0.8);
  bulb.position_W = {0.1, 0.0, 0.5};
  bulb.casts_shadows = false;
  const CameraModel camera(rgbConfig());
  const FineImage image = renderFine(camera, kAbove, floorUnder({bulb}));
  std::set<int> values;
  for (int u = 60; u < 260; ++u) {
    const double x = (u - camera.cx()) / camera.fx(), y = (camera.cy() - 120) / camera.fy();
    const double expected = 255.0 * (0.1 + 0.8 * 0.5 / Eigen::Vector3d(x - 0.1, y, 0.5).norm());
    // A unit, 1 / 257 of a grey level, for the rounding; twice as much for the GPU's single precision.
    EXPECT_NEAR(image.pixel(u, 120)[0] / kUnits, expected, 3.0 / kUnits) << u;
    values.insert(image.pixel(u, 120)[0]);
  }
  EXPECT_GT(values.size(), 150u);  // of 200 pixels; bytes have about sixty
}

TEST(OpenGlFine, RoundedItIsTheImageOfEachEncodingLensAndQuality) {
  Scene scene = colourfulScene();
  scene.models.emplace_back("target", std::vector<Polygon>{lShape()}, Rgb{20, 77, 140});
  for (const char* encoding : {"rgb8", "bgr8", "mono8"}) {
    for (const bool lens : {false, true}) {
      for (const char* quality : {"normal", "high"}) {
        CameraConfig config = lens ? distortedConfig() : cameraConfig();
        config.encoding = encoding;
        config.quality = quality;
        const CameraModel camera(config);
        const Pose X_WC = lookingDown({0.03, -0.02, 0.5}, 0.2, 0.1, 0.4);
        const Image image = renderOpenGl(camera, X_WC, scene);
        const FineImage fine = renderFine(camera, X_WC, scene);
        ASSERT_EQ(fine.data.size(), image.data.size());
        double worst = 0.0;
        std::size_t between = 0;
        for (std::size_t i = 0; i < image.data.size(); ++i) {
          worst = std::max(worst, std::abs(fine.data[i] / kUnits - image.data[i]));
          between += fine.data[i] % 257 != 0;
        }
        // Bytes are rounded for each sample, for their mean, for the lens along rows and columns, and where faces mix.
        EXPECT_LE(worst, 5 * 0.5 + 0.01) << encoding << lens << quality;
        EXPECT_GT(between, image.data.size() / 20) << encoding << lens << quality;
      }
    }
  }
}

}  // namespace
}  // namespace aras_visual_servo_sim::testing::opengl_fine_test
