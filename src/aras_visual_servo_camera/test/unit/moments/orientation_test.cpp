// Orientation and which way round: every angle, from full size to twelve pixels, clean, noisy and hard-edged images. A
// wrong answer is never given; what cannot be told is flagged symmetric.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "aras_visual_servo_camera/extraction/moment_extractor.hpp"
#include "coverage_image.hpp"
#include "usual_vision.hpp"

namespace aras_visual_servo_camera::orientation_test {
namespace {

using testing::GreyImage;
using testing::Polygon;

constexpr double kPi = 3.14159265358979323846;
constexpr double kDeg = kPi / 180.0;
constexpr double kFocal_px = 195.05, kWidth_m = 0.14, kReferenceWidth_px = 85.0;
constexpr double kNoise_grey = 2.0;
// Twelve pixels wide, hard edges: half a pixel at either end of the axis is 5 degrees.
constexpr double kCoverageTolerance = 1.0 * kDeg, kBinaryTolerance = 8.0 * kDeg;

double angleBetween(double a, double b) { return std::abs(std::remainder(a - b, 2.0 * kPi)); }

enum class Image { kCoverage, kNoisy, kHardEdged };

/** Around its centroid, kWidth_m wide. */
Polygon normalisedOutline(Polygon p) {
  const std::vector<double> m = testing::polygonMoments(p, 1);
  const auto [left, right] =
      std::minmax_element(p.begin(), p.end(), [](const auto& a, const auto& b) { return a.x < b.x; });
  const double scale = kWidth_m / (right->x - left->x);
  for (auto& q : p) q = {scale * (q.x - m[1] / m[0]), scale * (q.y - m[2] / m[0])};
  return p;
}

/** A rectangle whose right side is shorter by `part`. */
Polygon tapered(double part) {
  const double half = 0.04 * (1.0 - part);
  return {{-0.07, -0.04}, {0.07, -half}, {0.07, half}, {-0.07, 0.04}};
}

struct Shape {
  const char* name;
  Polygon outline;
};

std::vector<Shape> asymmetricShapes() {
  return {{"blob", testing::blob(kWidth_m)},
          {"triangle", testing::triangle(kWidth_m)},
          {"L", {{-0.08, -0.05}, {0.12, -0.05}, {0.12, 0.01}, {-0.02, 0.01}, {-0.02, 0.09}, {-0.08, 0.09}}},
          {"quadrangle", {{-0.06, -0.05}, {0.06, -0.03}, {0.05, 0.05}, {-0.03, 0.04}}},
          {"tapered by 0.2", tapered(0.2)}};
}

struct Count {
  int views = 0, wrong = 0, flagged = 0;
  double worst_rad = 0.0;  // error of an angle that is not flagged
};

/** All angles of one shape at one width, each looked at anew. */
Count turnedAround(const Polygon& outline, double width_px, Image kind, double step_deg) {
  const int side = static_cast<int>(2.0 * std::max(width_px, kReferenceWidth_px)) + 16;
  const double c = 0.5 * (side - 1);
  const CameraIntrinsics camera(side, side, {kFocal_px, 0, c, 0, kFocal_px, c, 0, 0, 1}, "", {});
  VisionConfig config = testing::usualVision();
  config.min_area_px = 20;  // the triangle of 12 px covers 43
  if (kind == Image::kHardEdged) config.segmentation = SegmentationMethod::kOtsu;
  MomentExtractor extractor(camera, config);
  std::mt19937 random(11);
  const auto look = [&](double yaw, double width, double offset_px) {
    const double depth = kWidth_m * kFocal_px / width, offset_m = offset_px * depth / kFocal_px;
    const Polygon p = testing::project(normalisedOutline(outline), {offset_m, -0.7 * offset_m, depth, yaw, 0.0, 0.0});
    GreyImage image = kind == Image::kHardEdged ? testing::binaryImage(p, camera) : testing::coverageImage(p, camera);
    if (kind == Image::kNoisy) testing::addNoise(kNoise_grey, &random, &image);
    return extractor.process(image.view());
  };
  extractor.setReference(kWidth_m * kFocal_px / kReferenceWidth_px, look(0.0, kReferenceWidth_px, 0.0));
  const double alpha_star = extractor.reference()->alpha_star;
  Count count;
  for (double degrees = 0.0; degrees < 360.0; degrees += step_deg) {
    extractor.forgetPrevious();
    const MomentFeatures f = look(degrees * kDeg, width_px, std::sin(7.0 * degrees));  // pixels are met anywhere
    ++count.views;
    EXPECT_TRUE(f.valid);
    EXPECT_TRUE(f.alpha > -kPi && f.alpha <= kPi) << f.alpha;
    count.flagged += f.symmetric;
    if (f.symmetric) continue;
    const double error = angleBetween(f.alpha, alpha_star + degrees * kDeg);
    count.wrong += error > 0.5 * kPi;
    count.worst_rad = std::max(count.worst_rad, error);
  }
  return count;
}

class Width : public ::testing::TestWithParam<double> {
 protected:
  double step_deg() const { return GetParam() > 40.0 ? 30.0 : 7.0; }
};
INSTANTIATE_TEST_SUITE_P(Orientation, Width, ::testing::Values(150.0, 60.0, 40.0, 24.0, 16.0, 12.0));

TEST_P(Width, AsymmetricShapesAreNeverTakenForTheirHalfTurn) {
  for (const Shape& shape : asymmetricShapes()) {
    for (const Image kind : {Image::kCoverage, Image::kNoisy}) {
      const Count count = turnedAround(shape.outline, GetParam(), kind, step_deg());
      EXPECT_EQ(count.wrong, 0) << shape.name;
      EXPECT_EQ(count.flagged, 0) << shape.name << ", noise " << (kind == Image::kNoisy);
      if (kind == Image::kCoverage) {
        EXPECT_LT(count.worst_rad, kCoverageTolerance) << shape.name;
      }
    }
    const Count count = turnedAround(shape.outline, GetParam(), Image::kHardEdged, step_deg());
    EXPECT_EQ(count.wrong, 0) << shape.name << ", hard edges";
    EXPECT_LT(count.worst_rad, kBinaryTolerance) << shape.name << ", hard edges";
    if (GetParam() < 40.0) continue;
    EXPECT_EQ(count.flagged, 0) << shape.name << ", hard edges";
  }
}

TEST_P(Width, BarelyAsymmetricShapesAreFlaggedRatherThanWrong) {
  for (const double taper : {0.15, 0.1, 0.05, 0.0}) {
    for (const Image kind : {Image::kCoverage, Image::kNoisy, Image::kHardEdged}) {
      const Count count = turnedAround(tapered(taper), GetParam(), kind, step_deg());
      EXPECT_EQ(count.wrong, 0) << taper << ", kind of image " << static_cast<int>(kind);
      if (taper > 0.07) continue;
      EXPECT_EQ(count.flagged, count.views) << taper << " is below asymmetry_threshold";
    }
  }
}

struct Orientation : ::testing::Test {
  MomentFeatures look(const Polygon& outline, const testing::View& view, double noise_grey = 0.0) {
    GreyImage image = testing::coverageImage(testing::project(outline, view), camera);
    if (noise_grey > 0.0) testing::addNoise(noise_grey, &random, &image);
    return extractor.process(image.view());
  }
  MomentFeatures lookTurned(const Polygon& outline, double degrees, double noise_grey = 0.0) {
    return look(outline, {0.01, -0.02, 0.6, degrees * kDeg, 0.0, 0.0}, noise_grey);
  }

  const CameraIntrinsics camera = testing::testCamera();
  MomentExtractor extractor{camera, testing::usualVision()};
  std::mt19937 random{7};
  const Polygon blob = testing::blob(0.14), slab = testing::rectangle(0.14, 0.09);
};

TEST_F(Orientation, NoisyBlobKeepsItsBranch) {
  extractor.setReference(0.6, lookTurned(blob, 0.0, 5.0));
  const double alpha_star = extractor.reference()->alpha_star;
  for (int degrees = -180; degrees < 180; degrees += 24)
    EXPECT_LT(angleBetween(lookTurned(blob, degrees, 5.0).alpha, alpha_star + degrees * kDeg), kCoverageTolerance)
        << degrees;
}

TEST_F(Orientation, TiltedBlobKeepsItsBranch) {
  extractor.setReference(0.5, look(blob, {0.0, 0.0, 0.5, 0.0, 0.0, 0.0}));
  const double alpha_star = extractor.reference()->alpha_star;
  for (int degrees = -180; degrees < 180; degrees += 30) {
    const MomentFeatures f = look(blob, {0.03, 0.02, 0.6, degrees * kDeg, 0.25, -0.2});
    // tilt turns the axis of a parallel view by some degrees; a wrong branch is 180 degrees away
    EXPECT_LT(angleBetween(f.alpha, alpha_star + degrees * kDeg), 20.0 * kDeg) << degrees;
  }
}

TEST_F(Orientation, SymmetricObjectIsContinuedFromTheLastView) {
  extractor.setReference(0.6, lookTurned(slab, 0.0));
  for (int degrees = 0; degrees <= 170; degrees += 10) {
    const MomentFeatures f = lookTurned(slab, degrees);
    EXPECT_TRUE(f.symmetric);
    EXPECT_LT(angleBetween(f.alpha, degrees * kDeg), kCoverageTolerance) << degrees;
  }
  extractor.forgetPrevious();  // then the reference counts: 170 degrees is nearer as -10
  EXPECT_LT(angleBetween(lookTurned(slab, 170.0).alpha, -10 * kDeg), kCoverageTolerance);
}

TEST_F(Orientation, ASecondTeachOfASymmetricObjectForgetsTheLastView) {
  for (const double sign : {1.0, -1.0}) {
    const MomentFeatures first = lookTurned(slab, 0.0);
    extractor.setReference(0.6, first);
    for (int degrees = 0; degrees <= 170; degrees += 10) lookTurned(slab, sign * degrees);
    EXPECT_LT(angleBetween(lookTurned(slab, sign * 170.0).alpha, sign * 170.0 * kDeg), kCoverageTolerance);
    extractor.setReference(0.6, first);
    EXPECT_LT(angleBetween(lookTurned(slab, sign * 170.0).alpha, sign * -10.0 * kDeg), kCoverageTolerance);
    extractor.clearReference();
    EXPECT_FALSE(lookTurned(slab, sign * 170.0).has_reference);
    extractor.setReference(0.6, lookTurned(slab, sign * 60.0));
    EXPECT_LT(angleBetween(lookTurned(slab, sign * 60.0).alpha, extractor.reference()->alpha_star), kCoverageTolerance);
  }
}

TEST_F(Orientation, WithoutReferenceAlphaLiesInAHalfTurn) {
  for (int degrees = -180; degrees < 180; degrees += 45) {
    const MomentFeatures f = lookTurned(blob, degrees);
    EXPECT_TRUE(f.alpha > -kPi / 2 && f.alpha <= kPi / 2) << f.alpha;
    EXPECT_FALSE(f.has_reference);
  }
}

TEST_F(Orientation, DiscAndSquareHaveNone) {
  for (const Polygon& shape : {testing::ellipse(0.075, 0.075, 0.0, {0.025, 0.01}, 360), testing::rectangle(0.1, 0.1)}) {
    const MomentFeatures f = look(shape, {0.01, -0.02, 0.5, 0.4, 0.0, 0.0});
    EXPECT_TRUE(f.target_visible);
    EXPECT_TRUE(std::isnan(f.alpha));
    EXPECT_FALSE(f.valid);
    EXPECT_TRUE(std::isfinite(f.xg));
    EXPECT_LT(f.orientation_condition, 0.01);
  }
}

TEST_F(Orientation, LineHasTheDirectionOfTheLine) {
  for (int degrees : {0, 30, 90, 135}) {
    const MomentFeatures f = lookTurned(testing::rectangle(0.24, 0.006), degrees);  // two pixels wide
    EXPECT_LT(std::abs(std::remainder(f.alpha - degrees * kDeg, kPi)), kCoverageTolerance) << degrees;
    EXPECT_GT(f.orientation_condition, 0.99);
    EXPECT_LE(f.orientation_condition, 1.0);
  }
}

}  // namespace
}  // namespace aras_visual_servo_camera::orientation_test
