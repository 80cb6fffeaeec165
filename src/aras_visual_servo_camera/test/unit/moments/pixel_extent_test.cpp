// What the extent of pixels adds to the moments of an image by coverage, where the lens distorts.
#include <gtest/gtest.h>

#include <cmath>

#include "aras_visual_servo_camera/moments/moments.hpp"
#include "coverage_image.hpp"

namespace aras_visual_servo_camera {
namespace {

constexpr double kStep_px = 1e-4;      // of central differences
constexpr double kDifferences = 1e-6;  // relative: of such differences
constexpr int kHalf = 3;               // [px] half the side of the object

ObjectMask squareAt(const CameraIntrinsics& camera, int u, int v, bool soft_edges) {
  ObjectMask mask;
  mask.width_px = camera.width();
  mask.height_px = camera.height();
  mask.visible = true;
  mask.soft_edges = soft_edges;
  for (int row = v - kHalf; row <= v + kHalf; ++row) {
    mask.spans.push_back({row, u - kHalf, u + kHalf + 1});
    mask.edge.push_back({row, u - kHalf - 1, 0.5, 0.0, 0.0});
  }
  return mask;
}

class Corner : public ::testing::TestWithParam<std::pair<int, int>> {};
// Near the four corners of the image, where the lens bends most, and in its middle.
INSTANTIATE_TEST_SUITE_P(PixelExtent, Corner,
                         ::testing::Values(std::pair(12, 12), std::pair(307, 12), std::pair(12, 227),
                                           std::pair(307, 227), std::pair(160, 120)));

TEST_P(Corner, SecondMomentsGrowByTheVarianceOfAPixelThroughTheLens) {
  for (bool distorted : {false, true}) {
    const CameraIntrinsics camera = testing::testCamera(distorted);
    const PixelMap map(camera);
    MomentAccumulator accumulator(map, 3);
    const auto [u, v] = GetParam();
    const std::vector<double> hard = accumulator.process(squareAt(camera, u, v, false));
    const std::vector<double> soft = accumulator.process(squareAt(camera, u, v, true));
    // Whole pixels have a variance of 1/12 px^2, parts of pixels of 1/16.
    const double whole = (2 * kHalf + 1) * (2 * kHalf + 1), parts = 0.5 * (2 * kHalf + 1);
    const double variance = (whole / 12.0 + parts / 16.0) / (whole + parts);
    // d(x, y) / d(u, v) where the centroid is seen, by central differences.
    const auto centre = camera.project(hard[momentIndex(1, 0)] / hard[0], hard[momentIndex(0, 1)] / hard[0]);
    const auto right = camera.undistort(centre[0] + kStep_px, centre[1]);
    const auto left = camera.undistort(centre[0] - kStep_px, centre[1]);
    const auto below = camera.undistort(centre[0], centre[1] + kStep_px);
    const auto above = camera.undistort(centre[0], centre[1] - kStep_px);
    const double xu = (right.x - left.x) / (2.0 * kStep_px), yu = (right.y - left.y) / (2.0 * kStep_px);
    const double xv = (below.x - above.x) / (2.0 * kStep_px), yv = (below.y - above.y) / (2.0 * kStep_px);
    const double scale = variance * hard[0] * (xu * xu + yv * yv);
    const auto grown = [&](int i, int j) { return soft[momentIndex(i, j)] - hard[momentIndex(i, j)]; };
    EXPECT_NEAR(grown(2, 0), variance * hard[0] * (xu * xu + xv * xv), kDifferences * scale) << distorted;
    EXPECT_NEAR(grown(1, 1), variance * hard[0] * (xu * yu + xv * yv), kDifferences * scale) << distorted;
    EXPECT_NEAR(grown(0, 2), variance * hard[0] * (yu * yu + yv * yv), kDifferences * scale) << distorted;
    EXPECT_EQ(grown(0, 0), 0.0);
    EXPECT_EQ(grown(1, 0), 0.0);
  }
}

}  // namespace
}  // namespace aras_visual_servo_camera
