// Kernel projections of rendered objects against exact integrals over their outlines.
#include <gtest/gtest.h>

#include <cmath>

#include "aras_visual_servo_camera/extraction/moment_extractor.hpp"
#include "coverage_image.hpp"
#include "usual_vision.hpp"

namespace aras_visual_servo_camera::kernel_projection_test {
namespace {

using testing::Polygon;

// Sums at pixel centres: p (p + 1) / 24 of a pixel over X squared, 60 pixels from the corner, is 2e-4 for p = 3; greys
// in steps of 1 / 210 along an edge of 200 pixels add 1e-4.
constexpr double kPixels = 5e-4;

/** Integral over the polygon of X^-n y^j: a fine sum over strips in x. */
double integral(const Polygon& outline, double x0, double n, int j, bool swapped) {
  constexpr int kSteps = 64;  // midpoints on each edge; the error falls with their square: 1e-6 here
  double sum = 0.0;
  for (std::size_t k = 0; k < outline.size(); ++k) {
    const auto a = outline[k], b = outline[(k + 1) % outline.size()];
    const double ax = swapped ? a.y : a.x, ay = swapped ? a.x : a.y, bx = swapped ? b.y : b.x, by = swapped ? b.x : b.y;
    for (int i = 0; i < kSteps; ++i) {
      const double t = (i + 0.5) / kSteps, x = ax + t * (bx - ax), y = ay + t * (by - ay);
      sum += std::pow(x - x0, -n) * std::pow(y, j + 1) / (j + 1) * (bx - ax) / kSteps;
    }
  }
  return sum;
}

TEST(KernelProjection, MeetsTheIntegralsOverTheOutline) {
  const Polygon outline = testing::project(testing::blob(0.16), {0.02, -0.03, 0.5, 0.7, 0.3, -0.2});
  for (const bool distorted : {false, true}) {
    const CameraIntrinsics camera = testing::testCamera(distorted);
    VisionConfig config = testing::usualVision();
    config.kernel = KernelConfig{1.5, 3.0};
    MomentExtractor extractor(camera, config);
    const MomentFeatures& f = extractor.process(testing::coverageImage(outline, camera).view());
    ASSERT_EQ(f.kernel_x.size(), 8u);
    ASSERT_EQ(f.kernel_y.size(), 8u);
    EXPECT_EQ(f.kernel_x[0], 1.5);
    EXPECT_EQ(f.kernel_y[0], 3.0);
    const double sign = integral(outline, f.kernel_x[1], 0.0, 0, false) > 0.0 ? 1.0 : -1.0;
    for (int k = 0; k < 3; ++k) {
      for (int j = 0; j < 2; ++j) {
        const double x = sign * integral(outline, f.kernel_x[1], 0.5 + k, j, false);
        const double y = -sign * integral(outline, f.kernel_y[1], 2.0 + k, j, true);
        // the integral with y^j hardly differs from zero: against the one without
        const double scale_x = std::abs(f.kernel_x[2 + 2 * k]), scale_y = std::abs(f.kernel_y[2 + 2 * k]);
        EXPECT_NEAR(f.kernel_x[2 + 2 * k + j], x, kPixels * scale_x) << k << j << distorted;
        EXPECT_NEAR(f.kernel_y[2 + 2 * k + j], y, kPixels * scale_y) << k << j << distorted;
      }
    }
  }
}

TEST(KernelProjection, TheCornerLiesOutsideEveryRayOfTheImage) {
  for (const bool distorted : {false, true}) {
    const CameraIntrinsics camera = testing::testCamera(distorted);
    VisionConfig config = testing::usualVision();
    config.kernel.emplace();
    MomentExtractor extractor(camera, config);
    testing::GreyImage image(320, 240, testing::kObjectGrey);  // all of it object, but for a patch that is background
    for (int v = 100; v < 140; ++v)
      for (int u = 100; u < 200; ++u) image.at(u, v) = testing::kBackgroundGrey;
    const MomentFeatures& f = extractor.process(image.view());
    ASSERT_EQ(f.kernel_x.size(), 8u);
    for (const double value : f.kernel_x) EXPECT_TRUE(std::isfinite(value));
    EXPECT_LT(f.kernel_x[1], camera.undistort(0, 0).x);
    EXPECT_LT(f.kernel_y[1], camera.undistort(0, 0).y);
  }
}

TEST(KernelProjection, IsEmptyWithoutATargetAndWhereItIsNotAskedFor) {
  const CameraIntrinsics camera = testing::testCamera();
  VisionConfig config = testing::usualVision();
  MomentExtractor without(camera, config);
  const testing::GreyImage image =
      testing::coverageImage(testing::project(testing::blob(0.1), {0, 0, 0.5, 0, 0, 0}), camera);
  EXPECT_TRUE(without.process(image.view()).kernel_x.empty());
  config.kernel.emplace();
  MomentExtractor with(camera, config);
  EXPECT_EQ(with.process(image.view()).kernel_y.size(), 8u);
  EXPECT_TRUE(with.process(testing::GreyImage(320, 240, 230).view()).kernel_y.empty());
}

}  // namespace
}  // namespace aras_visual_servo_camera::kernel_projection_test
