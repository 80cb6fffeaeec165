// Lenses against the coverage renderer.
#include <gtest/gtest.h>

#include <cmath>

#include "opengl_tools.hpp"

namespace aras_visual_servo_sim::testing::opengl_lens_test {
namespace {

struct Lens {
  const char* name;
  CameraConfig config;
};

std::vector<Lens> lenses() {
  CameraConfig rational = cameraConfig();
  rational.distortion_model = "rational_polynomial";
  rational.distortion = {0.2, -0.05, 0.001, -0.001, 0.01, 0.5, 0.02, 0.005};
  CameraConfig wide = cameraConfig();
  wide.distortion_model = "equidistant";
  wide.horizontal_fov_rad = 2.6;
  CameraConfig round = wide;  // 220 degrees, with a black rim
  round.horizontal_fov_rad = 4.6;
  round.cutoff_angle_rad = 1.92;
  return {{"plumb_bob", distortedConfig()}, {"rational", rational}, {"equidistant", wide}, {"round", round}};
}

/** A dark ball off the axis: what the lens makes of it is neither symmetric nor straight. */
Scene ballScene() {
  Scene scene;
  scene.background = {230, 230, 230};
  scene.lighting.shadows = false;
  scene.bodies.push_back(solid("ball", makeSphere(0.1, 96), {0, 0, 0}, {0.15, 0.1, 0.0}));
  return scene;
}

TEST(OpenGlLens, SeesSolidsWhereTheCoverageRendererDoes) {
  for (Lens& lens : lenses()) {
    for (const char* quality : {"normal", "high"}) {
      lens.config.quality = quality;
      lens.config.encoding = "mono8";
      const CameraModel camera(lens.config);
      const Pose X_WC = lookingDown({0.0, 0.0, 0.4}, 0.1, 0.2, 0.3);
      const auto blob = [](const Image& image) {  // of what is darker than the background; the black rim has none of it
        Blob sum;
        for (int v = 20; v < image.height - 20; ++v) {
          for (int u = 60; u < image.width - 60; ++u) {
            const double weight = (230.0 - *image.pixel(u, v)) / 230.0;
            sum.area += weight;
            sum.centroid += weight * Eigen::Vector2d(u, v);
          }
        }
        sum.centroid /= sum.area;
        return sum;
      };
      const Blob expected = blob(render(camera, X_WC, ballScene()));
      const Blob found = blob(renderOpenGl(camera, X_WC, ballScene()));
      ASSERT_GT(expected.area, 500.0);
      // Interpolation keeps means; four samples a pixel err by 0.03 px over a hundred pixels of edge.
      EXPECT_LT((found.centroid - expected.centroid).norm(), 0.05) << lens.name << ' ' << quality;
      EXPECT_NEAR(found.area / expected.area, 1.0, 0.01) << lens.name << ' ' << quality;
    }
  }
}

TEST(OpenGlLens, EdgesAreWithinAPixelAllOverTheImage) {
  for (Lens& lens : lenses()) {
    lens.config.encoding = "rgb8";
    const CameraModel camera(lens.config);
    const Pose X_WC = lookingDown({0.01, 0.02, 0.25}, 0.2, -0.3, 0.5);
    const Image expected = render(camera, X_WC, colourfulScene());
    const Difference difference = differenceOf(expected, renderOpenGl(camera, X_WC, colourfulScene()));
    EXPECT_LE(difference.apart, 3) << lens.name;    // of thousands: where something is thinner than a pixel
    EXPECT_LE(difference.inside, 16) << lens.name;  // neighbours may differ by 12, and interpolation mixes them
    EXPECT_LE(std::abs(difference.mean), 0.5) << lens.name;
  }
}

TEST(OpenGlLens, TargetsKeepTheirExactCoverage) {
  for (Lens& lens : lenses()) {
    lens.config.encoding = "rgb8";
    const CameraModel camera(lens.config);
    const Pose X_WC = lookingDown({0.01, 0.02, 0.3}, 0.1, -0.1, 0.5);
    const Scene scene = sceneWith(lShape());
    EXPECT_EQ(renderOpenGl(camera, X_WC, scene).data, render(camera, X_WC, scene).data) << lens.name;
  }
}

}  // namespace
}  // namespace aras_visual_servo_sim::testing::opengl_lens_test
