// Corners of one object to a small part of a pixel, and which is which.
#include <gtest/gtest.h>

#include <cmath>

#include "aras_visual_servo_camera/config/errors.hpp"
#include "aras_visual_servo_camera/extraction/moment_extractor.hpp"
#include "coverage_image.hpp"
#include "point_views.hpp"

namespace aras_visual_servo_camera::corners_test {
namespace {

using testing::farthest_px;
using testing::GreyImage;
using testing::kCorner_px;
using testing::kQuad;
using testing::Polygon;
using testing::View;
using testing::withPoints;

constexpr double kDeg = 3.14159265358979323846 / 180.0;
// Stairs of one pixel, evened out along an edge.
constexpr double kBinaryCorner_px = 0.5;
// sigma 2 of 210 levels over the 5 pixels that cross an edge is 0.02 px, over 30 of them 0.004; a corner has two edges.
constexpr double kNoisyCorner_px = 0.05;

// Arms of two lengths: no rotation maps it onto itself.
const Polygon kEll{{-0.06, -0.06}, {-0.02, -0.06}, {-0.02, 0.02}, {0.04, 0.02}, {0.04, 0.06}, {-0.06, 0.06}};

MomentExtractor cornersOf(const CameraIntrinsics& camera, int count) {
  return MomentExtractor(camera, withPoints(PointSource::kCorners, count));
}

/** The same corners beginning with another one. */
Polygon startingAt(Polygon p, std::size_t first) {
  std::rotate(p.begin(), p.begin() + static_cast<std::ptrdiff_t>(first), p.end());
  return p;
}

Polygon fromTopLeft(const Polygon& p) {
  std::size_t first = 0;
  for (std::size_t k = 0; k < p.size(); ++k)
    if (p[k].x + p[k].y < p[first].x + p[first].y) first = k;
  return startingAt(p, first);
}

std::vector<View> tiltedViews() {
  return {{0.0, 0.0, 0.5, 0.1, 0.0, 0.0},        {0.02, -0.03, 0.5, 0.7, 0.3, -0.2},
          {-0.05, 0.02, 0.45, 1.9, -0.25, 0.35}, {0.04, 0.03, 0.6, -2.4, 0.4, 0.1},
          {-0.03, -0.04, 0.4, -0.9, -0.1, -0.4}, {0.0, 0.0, 0.8, 2.9, 0.5, 0.3}};
}

class Lens : public ::testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(Corners, Lens, ::testing::Values(false, true));

TEST_P(Lens, CornersMeetProjection) {
  const CameraIntrinsics camera = testing::testCamera(GetParam());
  for (const Polygon& shape : {testing::rectangle(0.12, 0.08), kEll, kQuad, testing::triangle(0.14)}) {
    MomentExtractor extractor = cornersOf(camera, static_cast<int>(shape.size()));
    for (const View& view : tiltedViews()) {
      const Polygon truth = fromTopLeft(testing::project(shape, view));
      const MomentFeatures f = extractor.process(testing::coverageImage(truth, camera).view());
      EXPECT_TRUE(f.valid) << shape.size() << " corners, yaw " << view.yaw_rad;
      EXPECT_LT(farthest_px(f, truth), kCorner_px) << shape.size() << " corners, yaw " << view.yaw_rad;
    }
  }
}

TEST(Corners, AreFoundInSmallHardEdgedAndNoisyImages) {
  const CameraIntrinsics camera = testing::testCamera();
  MomentExtractor extractor = cornersOf(camera, 4);
  const Polygon small = fromTopLeft(testing::project(kQuad, {0.05, 0.02, 1.4, 0.4, 0.1, 0.0}));  // 17 px wide
  EXPECT_LT(farthest_px(extractor.process(testing::coverageImage(small, camera).view()), small), kNoisyCorner_px);

  const Polygon truth = fromTopLeft(testing::project(kQuad, {0.02, -0.03, 0.5, 0.7, 0.3, -0.2}));
  GreyImage image = testing::coverageImage(truth, camera);
  std::mt19937 random(5);
  testing::addNoise(2.0, &random, &image);
  EXPECT_LT(farthest_px(extractor.process(image.view()), truth), kNoisyCorner_px);

  VisionConfig hard = withPoints(PointSource::kCorners, 4);
  hard.segmentation = SegmentationMethod::kOtsu;
  MomentExtractor binary(camera, hard);
  EXPECT_LT(farthest_px(binary.process(testing::binaryImage(truth, camera).view()), truth), kBinaryCorner_px);
}

TEST(Corners, StartAtTheTopLeftBeforeThereIsAReference) {
  const CameraIntrinsics camera = testing::testCamera();
  MomentExtractor extractor = cornersOf(camera, 6);
  for (int degrees = 0; degrees < 360; degrees += 40) {
    const Polygon truth = fromTopLeft(testing::project(kEll, {0.0, 0.0, 0.5, degrees * kDeg, 0.2, 0.0}));
    EXPECT_LT(farthest_px(extractor.process(testing::coverageImage(truth, camera).view()), truth), kCorner_px)
        << degrees;
  }
}

// An L is told from itself at any angle without anything in between; `truth` keeps the reference's order.
TEST(Corners, KeepTheOrderOfTheReferenceAtAnyAngle) {
  const CameraIntrinsics camera = testing::testCamera();
  MomentExtractor extractor = cornersOf(camera, 6);
  const Polygon reference = testing::project(kEll, {0.0, 0.0, 0.5, 0.0, 0.0, 0.0});
  extractor.setReference(0.5, extractor.process(testing::coverageImage(reference, camera).view()));
  ASSERT_LT(farthest_px(extractor.features(), reference), kCorner_px) << "the outline starts at the top left";
  for (int degrees = 0; degrees < 360; degrees += 15) {
    extractor.forgetPrevious();
    const Polygon truth = testing::project(kEll, {0.02, 0.01, 0.5, degrees * kDeg, 0.3, -0.2});
    const MomentFeatures& f = extractor.process(testing::coverageImage(truth, camera).view());
    EXPECT_TRUE(f.valid) << degrees;
    EXPECT_LT(farthest_px(f, truth), kCorner_px) << degrees;
  }
}

// Nothing in a single view of a rectangle tells one half turn from another: it is followed.
TEST(Corners, OfARectangleAreFollowedOverAFullTurn) {
  const CameraIntrinsics camera = testing::testCamera();
  MomentExtractor extractor = cornersOf(camera, 4);
  const auto look = [&](int degrees) {
    const Polygon truth = testing::project(testing::rectangle(0.12, 0.08), {0.02, 0.01, 0.5, degrees * kDeg, 0.2, 0.1});
    const MomentFeatures f = extractor.process(testing::coverageImage(truth, camera).view());
    return farthest_px(f, truth);
  };
  look(0);
  extractor.setReference(0.5, extractor.features());
  for (int degrees = 0; degrees <= 360; degrees += 10) EXPECT_LT(look(degrees), kCorner_px) << degrees;
  extractor.forgetPrevious();  // then the nearer of the two: 120 degrees is taken for -60
  look(120);
  EXPECT_TRUE(extractor.features().symmetric);
  EXPECT_TRUE(extractor.features().valid);
  EXPECT_GT(look(120), 1.0);
}

TEST(Corners, OfASquareHalfWayBetweenTwoAnswersAreNotGiven) {
  const CameraIntrinsics camera = testing::testCamera();
  MomentExtractor extractor = cornersOf(camera, 4);
  const auto look = [&](int degrees) {
    const Polygon square = testing::project(testing::rectangle(0.1, 0.1), {0.0, 0.0, 0.5, degrees * kDeg, 0.0, 0.0});
    return extractor.process(testing::coverageImage(square, camera).view());
  };
  extractor.setReference(0.5, look(0));  // valid though it has no orientation
  EXPECT_TRUE(std::isnan(extractor.features().alpha));
  extractor.forgetPrevious();
  const MomentFeatures f = look(45);
  EXPECT_TRUE(f.target_visible);
  EXPECT_FALSE(f.valid);
  EXPECT_TRUE(f.point_x.empty() && f.point_y.empty());
  EXPECT_TRUE(look(20).valid);
}

TEST(Corners, AreNotMadeUp) {
  struct Shape {
    Polygon outline;
    int corners;  // that may be found
  };
  const CameraIntrinsics camera = testing::testCamera();
  const std::vector<Shape> shapes{
      {testing::ellipse(0.15, 0.15, 0.0, {0.05, 0.02}, 360), 0},
      {testing::ellipse(0.2, 0.1, 0.5, {0.0, 0.0}, 360), 0},
      {testing::project(kQuad, {0.0, 0.0, 0.5, 0.3, 0.0, 0.0}), 4},
      {testing::project(kQuad, {0.4, 0.0, 0.5, 0.3, 0.0, 0.0}), 0},                            // cut by the border
      {testing::project(testing::rectangle(0.2, 0.005), {0.0, 0.0, 0.5, 0.3, 0.0, 0.0}), 0}};  // two pixels wide
  for (const Shape& shape : shapes) {
    for (const int count : {3, 4, 5, 6}) {
      MomentExtractor extractor = cornersOf(camera, count);
      const MomentFeatures f = extractor.process(testing::coverageImage(shape.outline, camera).view());
      EXPECT_EQ(f.point_x.empty(), count != shape.corners) << shape.outline.size() << " corners taken for " << count;
      EXPECT_EQ(f.valid, count == shape.corners);
    }
  }
  MomentExtractor extractor = cornersOf(camera, 4);
  EXPECT_FALSE(extractor.process(GreyImage(320, 240, testing::kBackgroundGrey).view()).target_visible);
  EXPECT_THROW(extractor.setReference(0.5, extractor.features()), DegenerateFeature);
}

}  // namespace
}  // namespace aras_visual_servo_camera::corners_test
