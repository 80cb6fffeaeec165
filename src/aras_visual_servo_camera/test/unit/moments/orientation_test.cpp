// Orientation and its 180 degree ambiguity, from full size down to twelve pixels.
#include <gtest/gtest.h>

#include <cmath>

#include "aras_visual_servo_camera/extraction/moment_extractor.hpp"
#include "coverage_image.hpp"
#include "usual_vision.hpp"

namespace aras_visual_servo_camera {
namespace {

using testing::Polygon;

constexpr double kPi = 3.14159265358979323846;
constexpr double kDeg = kPi / 180.0;
constexpr double kFocal_px = 195.05;
// Twelve pixels wide, hard edges: half a pixel at either end of the axis is 5 degrees.
constexpr double kCoverageTolerance = 1.0 * kDeg, kBinaryTolerance = 8.0 * kDeg;

double angleBetween(double a, double b) { return std::abs(std::remainder(a - b, 2.0 * kPi)); }

Polygon turned(const Polygon& outline, double yaw, double depth_m) {
  return testing::project(outline, {0.01, -0.02, depth_m, yaw, 0.0, 0.0});
}

class WidthInPixels : public ::testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Orientation, WidthInPixels, ::testing::Values(150, 85, 40, 20, 12));

void expectResolvedAtEveryAngle(const Polygon& outline, double size_m, int width_px, bool soft, double tolerance) {
  const CameraIntrinsics camera = testing::testCamera();
  VisionConfig config = testing::usualVision();
  config.segmentation = soft ? SegmentationMethod::kCoverage : SegmentationMethod::kOtsu;
  config.min_area_px = 20;  // the triangle of 12 px covers 43
  MomentExtractor extractor(camera, config);
  const double reference_depth = size_m * kFocal_px / 85.0, depth = size_m * kFocal_px / width_px;
  const auto look = [&](double yaw, double depth_m) {
    const Polygon p = turned(outline, yaw, depth_m);
    return extractor.process((soft ? testing::coverageImage(p, camera) : testing::binaryImage(p, camera)).view());
  };
  extractor.setReference(reference_depth, look(0.3, reference_depth));
  const double alpha_star = extractor.reference()->alpha_star;
  for (int degrees = -180; degrees < 180; degrees += 9) {
    const MomentFeatures f = look(0.3 + degrees * kDeg, depth);
    ASSERT_TRUE(f.valid);
    EXPECT_FALSE(f.symmetric) << degrees;
    EXPECT_LT(angleBetween(f.alpha, alpha_star + degrees * kDeg), tolerance) << degrees << " degrees";
    EXPECT_GT(f.alpha, -kPi);
    EXPECT_LE(f.alpha, kPi);
  }
}

TEST_P(WidthInPixels, BlobIsResolvedAtEveryAngle) {
  expectResolvedAtEveryAngle(testing::blob(0.14), 0.14, GetParam(), true, kCoverageTolerance);
}

TEST_P(WidthInPixels, TriangleIsResolvedAtEveryAngle) {
  expectResolvedAtEveryAngle(testing::triangle(0.14), 0.14, GetParam(), true, kCoverageTolerance);
}

TEST_P(WidthInPixels, HardEdgedTriangleIsResolvedAtEveryAngle) {
  expectResolvedAtEveryAngle(testing::triangle(0.14), 0.14, GetParam(), false, kBinaryTolerance);
}

TEST_P(WidthInPixels, RectangleIsFlaggedSymmetric) {
  const CameraIntrinsics camera = testing::testCamera();
  const double depth = 0.14 * kFocal_px / GetParam();
  for (int degrees = 0; degrees < 90; degrees += 15) {
    MomentExtractor extractor(camera, testing::usualVision());
    const Polygon p = turned(testing::rectangle(0.14, 0.09), degrees * kDeg, depth);
    const MomentFeatures f = extractor.process(testing::coverageImage(p, camera).view());
    EXPECT_TRUE(f.symmetric) << degrees << " degrees, asymmetry " << f.asymmetry;
    EXPECT_TRUE(f.valid);
  }
}

TEST(Orientation, NoisyBlobKeepsItsBranch) {
  const CameraIntrinsics camera = testing::testCamera();
  MomentExtractor extractor(camera, testing::usualVision());
  std::mt19937 random(7);
  const auto look = [&](double yaw) {
    testing::GreyImage image = testing::coverageImage(turned(testing::blob(0.14), yaw, 0.6), camera);
    testing::addNoise(5.0, &random, &image);
    return extractor.process(image.view());
  };
  extractor.setReference(0.6, look(0.0));
  const double alpha_star = extractor.reference()->alpha_star;
  for (int degrees = -180; degrees < 180; degrees += 24) {
    const MomentFeatures f = look(degrees * kDeg);
    EXPECT_LT(angleBetween(f.alpha, alpha_star + degrees * kDeg), kCoverageTolerance) << degrees;
  }
}

TEST(Orientation, TiltedBlobKeepsItsBranch) {
  const CameraIntrinsics camera = testing::testCamera();
  MomentExtractor extractor(camera, testing::usualVision());
  const auto look = [&](const testing::View& view) {
    return extractor.process(testing::coverageImage(testing::project(testing::blob(0.14), view), camera).view());
  };
  extractor.setReference(0.5, look({0.0, 0.0, 0.5, 0.0, 0.0, 0.0}));
  const double alpha_star = extractor.reference()->alpha_star;
  for (int degrees = -180; degrees < 180; degrees += 30) {
    const MomentFeatures f = look({0.03, 0.02, 0.6, degrees * kDeg, 0.25, -0.2});
    // tilt turns the axis of a parallel view by some degrees; a wrong branch is 180 degrees away
    EXPECT_LT(angleBetween(f.alpha, alpha_star + degrees * kDeg), 20.0 * kDeg) << degrees;
  }
}

TEST(Orientation, SymmetricObjectIsContinuedFromTheLastView) {
  const CameraIntrinsics camera = testing::testCamera();
  MomentExtractor extractor(camera, testing::usualVision());
  const auto look = [&](double yaw) {
    const Polygon p = turned(testing::rectangle(0.14, 0.09), yaw, 0.6);
    return extractor.process(testing::coverageImage(p, camera).view());
  };
  extractor.setReference(0.6, look(0.0));
  for (int degrees = 0; degrees <= 170; degrees += 10) {
    const MomentFeatures f = look(degrees * kDeg);
    EXPECT_TRUE(f.symmetric);
    EXPECT_LT(angleBetween(f.alpha, degrees * kDeg), kCoverageTolerance) << degrees;
  }
  extractor.forgetPrevious();  // then the reference counts: 170 degrees is nearer as -10
  EXPECT_LT(angleBetween(look(170 * kDeg).alpha, -10 * kDeg), kCoverageTolerance);
}

TEST(Orientation, ASecondTeachOfASymmetricObjectForgetsTheLastView) {
  const CameraIntrinsics camera = testing::testCamera();
  MomentExtractor extractor(camera, testing::usualVision());
  const auto look = [&](double degrees) {
    const Polygon p = turned(testing::rectangle(0.14, 0.09), degrees * kDeg, 0.6);
    return extractor.process(testing::coverageImage(p, camera).view());
  };
  for (const double sign : {1.0, -1.0}) {
    const MomentFeatures first = look(0.0);
    extractor.setReference(0.6, first);
    for (int degrees = 0; degrees <= 170; degrees += 10) look(sign * degrees);
    EXPECT_LT(angleBetween(look(sign * 170.0).alpha, sign * 170.0 * kDeg), kCoverageTolerance);
    extractor.setReference(0.6, first);
    EXPECT_LT(angleBetween(look(sign * 170.0).alpha, sign * -10.0 * kDeg), kCoverageTolerance);
    extractor.clearReference();
    EXPECT_FALSE(look(sign * 170.0).has_reference);
    extractor.setReference(0.6, look(sign * 60.0));
    EXPECT_LT(angleBetween(look(sign * 60.0).alpha, extractor.reference()->alpha_star), kCoverageTolerance);
  }
}

TEST(Orientation, WithoutReferenceAlphaLiesInAHalfTurn) {
  const CameraIntrinsics camera = testing::testCamera();
  MomentExtractor extractor(camera, testing::usualVision());
  for (int degrees = -180; degrees < 180; degrees += 45) {
    const MomentFeatures f =
        extractor.process(testing::coverageImage(turned(testing::blob(0.14), degrees * kDeg, 0.6), camera).view());
    EXPECT_GT(f.alpha, -kPi / 2);
    EXPECT_LE(f.alpha, kPi / 2);
    EXPECT_FALSE(f.has_reference);
  }
}

TEST(Orientation, DiscAndSquareHaveNone) {
  const CameraIntrinsics camera = testing::testCamera();
  for (const Polygon& shape :
       {testing::ellipse(0.15, 0.15, 0.0, {0.05, 0.02}, 360), turned(testing::rectangle(0.1, 0.1), 0.4, 0.5)}) {
    MomentExtractor extractor(camera, testing::usualVision());
    const MomentFeatures f = extractor.process(testing::coverageImage(shape, camera).view());
    EXPECT_TRUE(f.target_visible);
    EXPECT_TRUE(std::isnan(f.alpha));
    EXPECT_FALSE(f.valid);
    EXPECT_TRUE(std::isfinite(f.xg));
    EXPECT_LT(f.orientation_condition, 0.01);
  }
}

TEST(Orientation, LineHasTheDirectionOfTheLine) {
  const CameraIntrinsics camera = testing::testCamera();
  for (int degrees : {0, 30, 90, 135}) {
    const Polygon line = turned(testing::rectangle(0.2, 0.005), degrees * kDeg, 0.5);  // two pixels wide
    MomentExtractor extractor(camera, testing::usualVision());
    const MomentFeatures f = extractor.process(testing::coverageImage(line, camera).view());
    EXPECT_LT(std::abs(std::remainder(f.alpha - degrees * kDeg, kPi)), kCoverageTolerance) << degrees;
    EXPECT_GT(f.orientation_condition, 0.99);
    EXPECT_LE(f.orientation_condition, 1.0);
  }
}

}  // namespace
}  // namespace aras_visual_servo_camera
