// Images before they are rounded to bytes: what a noisy sensor gets.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tools/render_tools.hpp"

namespace aras_visual_servo_sim::testing::fine_image_test {
namespace {

constexpr double kUnits = kUnitsOf<std::uint16_t>;

FineImage renderFine(const CameraModel& camera, const Pose& X_WC, const Scene& scene) {
  CoverageRenderer renderer;
  FineImage image;
  renderer.render(camera, X_WC, scene, image);
  return image;
}

/** Target with a picture before a board, and a lit sphere and a box among them. */
Scene everything() {
  std::vector<std::uint8_t> rgb;
  for (int k = 0; k < 64 * 48 * 3; ++k) rgb.push_back(static_cast<std::uint8_t>(k * 7 % 251));
  Scene scene;
  scene.background = {200, 180, 33};
  scene.models.emplace_back("target", std::vector<Polygon>{lShape()}, Rgb{20, 77, 140},
                            PlanarModel::Board{{0.4, 0.3}, {250, 240, 230}});
  scene.models.emplace_back("photo", std::vector<Polygon>{}, Rgb{}, std::nullopt,
                            PlanarModel::Picture{std::make_shared<Texture>("photo", 64, 48, rgb), {0.1, 0.08}});
  scene.models.back().X_WM.p = {0.12, 0.1, 0.02};
  Body body;
  body.name = "box";
  body.shapes.push_back({Pose{}, makeBox({0.05, 0.06, 0.07}), {255, 120, 10}});
  body.X_WB = {{-0.12, 0.06, 0.05}, Eigen::Quaterniond(Eigen::AngleAxisd(0.5, Eigen::Vector3d(1, 2, 3).normalized()))};
  scene.bodies.push_back(body);
  return scene;
}

TEST(FineImage, EdgesAreNotRoundedToGreyLevels) {
  const CameraModel camera(cameraConfig());
  const Scene scene = sceneWith({{-0.05, -0.05}, {0.05, -0.05}, {0.05, 0.05}, {-0.05, 0.05}});
  for (int k = 0; k < 20; ++k) {
    const double offset_m = 0.0001 * k;
    const FineImage image = renderFine(camera, lookingDown({offset_m, 0.0071, 0.4}), scene);
    const double edge = camera.cx() + camera.fx() * (-0.05 - offset_m) / 0.4;  // [px] the left one
    const int u = static_cast<int>(std::floor(edge + 0.5)), v = 120;
    const double covered = u + 0.5 - edge, expected = 230.0 - 210.0 * covered;
    // Half a unit of rounding, and what single precision leaves of 230 levels in sums of areas.
    EXPECT_NEAR(*image.pixel(u, v) / kUnits, expected, 0.5 / kUnits + 1e-3) << "offset " << offset_m;
  }
}

TEST(FineImage, RoundedItIsTheImageOfEachEncodingAndLens) {
  for (const char* encoding : {"rgb8", "bgr8", "mono8"}) {
    for (CameraConfig config : {cameraConfig(), distortedConfig()}) {
      config.encoding = encoding;
      const CameraModel camera(config);
      const Pose X_WC = lookingDown({0.03, -0.02, 0.5}, 0.2, 0.1, 0.4);
      const Image image = render(camera, X_WC, everything());
      const FineImage fine = renderFine(camera, X_WC, everything());
      ASSERT_EQ(fine.data.size(), image.data.size());
      double worst = 0.0;
      std::size_t between = 0;
      for (std::size_t i = 0; i < image.data.size(); ++i) {
        worst = std::max(worst, std::abs(fine.data[i] / kUnits - image.data[i]));
        between += fine.data[i] % 257 != 0;
      }
      // Bytes are rounded once for each of the faces that are blended over a pixel: picture, board, target, solid.
      EXPECT_LE(worst, 4 * 0.5 + 0.01) << encoding;
      EXPECT_GT(between, image.data.size() / 100) << encoding;
    }
  }
}

}  // namespace
}  // namespace aras_visual_servo_sim::testing::fine_image_test
