#include "aras_visual_servo_camera/moments/moments.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "aras_visual_servo_camera/config/errors.hpp"
#include "coverage_image.hpp"

namespace aras_visual_servo_camera::moments_test {
namespace {

constexpr double kRounding = 1e-12;  // relative, of sums over thousands of pixels

ObjectMask maskOf(const CameraIntrinsics& camera, std::vector<Span> spans, std::vector<EdgePixel> edge = {}) {
  ObjectMask mask;
  mask.width_px = camera.width();
  mask.height_px = camera.height();
  mask.visible = true;
  mask.spans = std::move(spans);
  mask.edge = std::move(edge);
  return mask;
}

TEST(Moments, NamesAndIndicesAgree) {
  const std::vector<std::string> names = momentNames(4);
  ASSERT_EQ(names.size(), static_cast<std::size_t>(momentCount(4)));
  for (int i = 0; i <= 4; ++i)
    for (int j = 0; i + j <= 4; ++j) EXPECT_EQ(names[momentIndex(i, j)], std::to_string(i) + std::to_string(j));
}

TEST(Moments, AreTheSumsOfTheirDefinition) {
  // Between pixels the ray is taken as linear: with this lens, at the border, off by so much of a pixel's width.
  constexpr double kBend = 2e-2;
  for (bool distorted : {false, true}) {
    const CameraIntrinsics camera = testing::testCamera(distorted);
    const PixelMap map(camera);
    MomentAccumulator accumulator(map, 4);
    for (bool between : {false, true}) {
      const double off = between ? 1.0 : 0.0;
      const ObjectMask mask = maskOf(camera, {{50, 100, 140}, {51, 90, 95}, {51, 97, 130}},
                                     {{49, 101, 0.25, 0.3 * off, -0.2 * off},
                                      {51, 95, 0.5, -0.25 * off, 0.1 * off},
                                      {52, 319, 0.125, 0.4 * off, 0.4 * off}});
      std::vector<double> expected(momentCount(4), 0.0);
      const auto add = [&](int u, int v, double du, double dv, double weight) {
        const auto ray = camera.undistort(u + du, v + dv);
        const double area = ray.jacobian[0] * ray.jacobian[3] - ray.jacobian[1] * ray.jacobian[2];
        for (int i = 0; i <= 4; ++i)
          for (int j = 0; i + j <= 4; ++j)
            expected[momentIndex(i, j)] += weight * area * std::pow(ray.x, i) * std::pow(ray.y, j);
      };
      for (const Span& s : mask.spans)
        for (int u = s.u_begin; u < s.u_end; ++u) add(u, s.v, 0.0, 0.0, 1.0);
      for (const EdgePixel& e : mask.edge) add(e.u, e.v, e.du, e.dv, e.weight);
      const double pixel = mask.edge[0].weight / std::pow(camera.fx(), 3);  // one edge pixel moved by its width
      const double allowed = kRounding * expected[0] + (distorted && between ? kBend * pixel : 0.0);
      const std::vector<double>& m = accumulator.process(mask);
      for (int k = 0; k < momentCount(4); ++k) EXPECT_NEAR(m[k], expected[k], allowed) << distorted << between << k;
    }
  }
}

TEST(Moments, AreaElementsAddUpToTheViewedArea) {
  // Corners of the image undistorted by the same lens bound the view; its area by the midpoint rule, error of order
  // w^2.
  constexpr double kMidpoint = 1e-5;
  const CameraIntrinsics camera = testing::testCamera(true);
  const PixelMap map(camera);
  std::vector<Span> all;
  for (int v = 60; v < 180; ++v) all.push_back({v, 80, 240});
  const double area = MomentAccumulator(map, 0).process(maskOf(camera, all))[0];
  testing::Polygon outline;
  const auto side = [&](double u0, double v0, double u1, double v1) {
    for (int k = 0; k < 400; ++k) {
      const auto ray = camera.undistort(u0 + (u1 - u0) * k / 400, v0 + (v1 - v0) * k / 400);
      outline.push_back({ray.x, ray.y});
    }
  };
  side(79.5, 59.5, 239.5, 59.5);
  side(239.5, 59.5, 239.5, 179.5);
  side(239.5, 179.5, 79.5, 179.5);
  side(79.5, 179.5, 79.5, 59.5);
  EXPECT_NEAR(area / testing::polygonMoments(outline, 0)[0], 1.0, kMidpoint);
}

TEST(Moments, TheExtentOfPixelsAddsToEachOrderWhatTheCentroidsHad) {
  const CameraIntrinsics camera = testing::testCamera();
  const PixelMap map(camera);
  MomentAccumulator accumulator(map, 4);
  ObjectMask mask = maskOf(camera, {{120, 158, 162}, {121, 158, 164}});
  const std::vector<double> hard = accumulator.process(mask);
  mask.soft_edges = true;
  const std::vector<double> soft = accumulator.process(mask);
  const double variance = 1.0 / 12.0 / (camera.fx() * camera.fx());
  const auto at = [&hard](int i, int j) { return i < 0 || j < 0 ? 0.0 : hard[momentIndex(i, j)]; };
  for (int i = 0; i <= 4; ++i) {
    for (int j = 0; i + j <= 4; ++j) {
      const double added = 0.5 * variance * (i * (i - 1) * at(i - 2, j) + j * (j - 1) * at(i, j - 2));
      const double largest = hard[0] * std::pow(4.0 / camera.fx(), i + j);
      EXPECT_NEAR(soft[momentIndex(i, j)] - at(i, j), added, kRounding * largest) << i << j;
    }
  }
}

TEST(Moments, WeightsThatNoiseTookBelowZeroHaveNoExtent) {
  const CameraIntrinsics camera = testing::testCamera();
  const PixelMap map(camera);
  MomentAccumulator accumulator(map, 3);
  ObjectMask mask = maskOf(camera, {}, {{50, 100, 0.2}, {51, 101, -0.5}});
  const std::vector<double> hard = accumulator.process(mask);
  mask.soft_edges = true;
  EXPECT_EQ(accumulator.process(mask), hard);
}

TEST(Moments, AnObjectHasLeftTheLensInTheImagesInWhichItDoes) {
  // With this lens the corners of the image lie beyond the fold, where nothing has coordinates.
  const CameraIntrinsics camera(320, 240, {195.05, 0, 159.5, 0, 195.05, 119.5, 0, 0, 1}, "plumb_bob", {-0.8, 0, 0, 0});
  const PixelMap map(camera);
  ASSERT_FALSE(map.sees(2, 2));
  MomentAccumulator accumulator(map, 3);
  const std::vector<Span> whole{{120, 150, 160}};
  const std::vector<double> inside = accumulator.process(maskOf(camera, whole));
  EXPECT_FALSE(accumulator.leftTheLens());
  for (const ObjectMask& mask :
       {maskOf(camera, {{2, 2, 3}, whole[0]}), maskOf(camera, whole, {{2, 2, 0.5}, {237, 317, 0.1}})}) {
    EXPECT_EQ(accumulator.process(mask), inside) << "what has no coordinates has no moments";
    EXPECT_TRUE(accumulator.leftTheLens());
    accumulator.process(maskOf(camera, whole));
    EXPECT_FALSE(accumulator.leftTheLens());
  }
}

TEST(Moments, MaskOfAnotherWidthOrHeightIsAShapeError) {
  const PixelMap map(testing::testCamera());
  for (const auto& [width, height] : {std::pair(319, 240), std::pair(320, 241)}) {
    ObjectMask mask;
    mask.width_px = width;
    mask.height_px = height;
    EXPECT_THROW(MomentAccumulator(map, 3).process(mask), ShapeError) << width;
  }
}

TEST(Moments, EmptyMaskGivesZeros) {
  const CameraIntrinsics camera = testing::testCamera();
  const PixelMap map(camera);
  MomentAccumulator accumulator(map, 3);
  for (double m : accumulator.process(maskOf(camera, {}))) EXPECT_EQ(m, 0.0);
}

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

TEST(PolygonMoments, OfASquareAreTheTextbookOnes) {
  const auto m = testing::polygonMoments({{1, 2}, {3, 2}, {3, 4}, {1, 4}}, 3);
  const std::vector<double> expected{4, 8, 12, 52.0 / 3, 24, 112.0 / 3, 40, 52, 224.0 / 3, 120};
  for (int k = 0; k < 10; ++k) EXPECT_NEAR(m[k], expected[k], kRounding * expected[9]);
}

}  // namespace
}  // namespace aras_visual_servo_camera::moments_test
