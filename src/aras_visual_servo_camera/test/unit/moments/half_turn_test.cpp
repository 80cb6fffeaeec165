// Which way round: every angle, from full size to twelve pixels, clean, noisy and hard-edged images. A wrong answer is
// never given; what cannot be told is flagged symmetric.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "aras_visual_servo_camera/extraction/moment_extractor.hpp"
#include "coverage_image.hpp"
#include "usual_vision.hpp"

namespace aras_visual_servo_camera {
namespace {

using testing::GreyImage;
using testing::Polygon;

constexpr double kPi = 3.14159265358979323846;
constexpr double kDeg = kPi / 180.0;
constexpr double kFocal_px = 195.05, kWidth_m = 0.14, kReferenceWidth_px = 85.0;
constexpr double kNoise_grey = 2.0;

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
};

/** All angles of one shape at one width, each looked at anew. */
Count turnedAround(const Polygon& outline, double width_px, Image kind, double step_deg) {
  const int side = static_cast<int>(2.0 * std::max(width_px, kReferenceWidth_px)) + 16;
  const double c = 0.5 * (side - 1);
  const CameraIntrinsics camera(side, side, {kFocal_px, 0, c, 0, kFocal_px, c, 0, 0, 1}, "", {});
  VisionConfig config = testing::usualVision();
  config.min_area_px = 20;
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
    count.flagged += f.symmetric;
    count.wrong +=
        !f.symmetric && std::abs(std::remainder(f.alpha - alpha_star - degrees * kDeg, 2.0 * kPi)) > 0.5 * kPi;
  }
  return count;
}

class Width : public ::testing::TestWithParam<double> {
 protected:
  double step_deg() const { return GetParam() > 40.0 ? 30.0 : 7.0; }
};
INSTANTIATE_TEST_SUITE_P(HalfTurn, Width, ::testing::Values(150.0, 60.0, 40.0, 24.0, 16.0, 12.0));

TEST_P(Width, AsymmetricShapesAreNeverTakenForTheirHalfTurn) {
  for (const Shape& shape : asymmetricShapes()) {
    for (const Image kind : {Image::kCoverage, Image::kNoisy}) {
      const Count count = turnedAround(shape.outline, GetParam(), kind, step_deg());
      EXPECT_EQ(count.wrong, 0) << shape.name;
      EXPECT_EQ(count.flagged, 0) << shape.name << ", noise " << (kind == Image::kNoisy);
    }
    const Count count = turnedAround(shape.outline, GetParam(), Image::kHardEdged, step_deg());
    EXPECT_EQ(count.wrong, 0) << shape.name << ", hard edges";
    if (GetParam() < 40.0) continue;
    EXPECT_EQ(count.flagged, 0) << shape.name << ", hard edges";
  }
}

TEST_P(Width, BarelyAsymmetricShapesAreFlaggedRatherThanWrong) {
  for (const double taper : {0.15, 0.1, 0.05}) {
    for (const Image kind : {Image::kCoverage, Image::kNoisy, Image::kHardEdged}) {
      const Count count = turnedAround(tapered(taper), GetParam(), kind, step_deg());
      EXPECT_EQ(count.wrong, 0) << taper << ", kind of image " << static_cast<int>(kind);
      if (taper > 0.07) continue;
      EXPECT_EQ(count.flagged, count.views) << taper << " is below asymmetry_threshold";
    }
  }
}

}  // namespace
}  // namespace aras_visual_servo_camera
