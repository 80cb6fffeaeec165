// Pixels of a fisheye to which no ray belongs: black in the image, and no object.
#include <gtest/gtest.h>

#include <cmath>

#include "aras_visual_servo_camera/extraction/moment_extractor.hpp"
#include "coverage_image.hpp"
#include "usual_vision.hpp"

namespace aras_visual_servo_camera::blind_area_test {
namespace {

constexpr int kSize_px = 200;
constexpr double kFocal_px = 60.0, kCentre_px = 99.5;
constexpr double kWidest_rad = 80.0 * 3.14159265358979323846 / 180.0;  // beyond it nothing has coordinates
constexpr double kSeen_px = kFocal_px * kWidest_rad;

CameraIntrinsics fisheye() {
  return {
      kSize_px, kSize_px, {kFocal_px, 0, kCentre_px, 0, kFocal_px, kCentre_px, 0, 0, 1}, "equidistant", {0, 0, 0, 0}};
}

/** A disc of 12 px on a ground of another grey, all that is blind black. */
testing::GreyImage discAt(double u, double v, std::uint8_t disc = testing::kObjectGrey,
                          std::uint8_t ground = testing::kBackgroundGrey) {
  testing::GreyImage image(kSize_px, kSize_px, ground);
  for (int row = 0; row < kSize_px; ++row) {
    for (int column = 0; column < kSize_px; ++column) {
      if (std::hypot(column - u, row - v) < 12.0) image.at(column, row) = disc;
      if (std::hypot(column - kCentre_px, row - kCentre_px) > kSeen_px) image.at(column, row) = 0;
    }
  }
  return image;
}

VisionConfig config(SegmentationMethod method) {
  VisionConfig config = testing::usualVision();
  config.segmentation = method;
  return config;
}

class Method : public ::testing::TestWithParam<SegmentationMethod> {};
INSTANTIATE_TEST_SUITE_P(BlindArea, Method,
                         ::testing::Values(SegmentationMethod::kCoverage, SegmentationMethod::kFixed,
                                           SegmentationMethod::kOtsu));

TEST_P(Method, BlackBeyondTheLensIsNoObject) {
  MomentExtractor extractor(fisheye(), config(GetParam()));
  const MomentFeatures f = extractor.process(discAt(kCentre_px + 10.0, kCentre_px - 5.0).view());
  ASSERT_TRUE(f.target_visible);
  EXPECT_EQ(f.components, 1);
  EXPECT_FALSE(f.touches_border);
  const double theta = std::hypot(10.0, 5.0) / kFocal_px;  // of the middle of the disc
  EXPECT_NEAR(std::hypot(f.xg, f.yg), std::tan(theta), 0.05 * std::tan(theta));
}

// The blind pixels are as many as those of the ground: as a grey of the image they would make the ground an object.
TEST_P(Method, BlindPixelsDoNotCountAmongTheGreys) {
  for (const ObjectShade shade : {ObjectShade::kDark, ObjectShade::kBright}) {
    const bool dark = shade == ObjectShade::kDark;
    VisionConfig vision = config(GetParam());
    vision.object = shade;
    vision.threshold = 140.0;
    MomentExtractor extractor(fisheye(), vision);
    const auto image = discAt(kCentre_px + 10.0, kCentre_px, dark ? 120 : 160, dark ? 160 : 120);
    const MomentFeatures f = extractor.process(image.view());
    EXPECT_TRUE(f.target_visible && !f.touches_border) << dark;
    EXPECT_LT(f.area, 0.2) << dark;  // the disc has 0.13, the ground some 40
  }
}

TEST_P(Method, AnObjectThatReachesIntoTheBlindAreaIsCutOnEverySide) {
  for (const auto& [x, y] : {std::pair(1, 0), std::pair(-1, 0), std::pair(0, 1), std::pair(0, -1)}) {
    MomentExtractor extractor(fisheye(), config(GetParam()));
    const auto at = [&, x = x, y = y](double radius_px) {  // which clang does not capture by itself
      return extractor.process(discAt(kCentre_px + x * radius_px, kCentre_px + y * radius_px).view());
    };
    const MomentFeatures inside = at(kSeen_px - 20.0), cut = at(kSeen_px - 8.0);
    EXPECT_TRUE(inside.target_visible && !inside.touches_border) << x << y;
    EXPECT_TRUE(cut.target_visible && cut.touches_border && !cut.valid) << x << y;
  }
}

/** A rational lens that folds 71 px from the axis: what is farther away is in the image, and has no coordinates. */
TEST_P(Method, AnObjectBeyondTheFoldOfTheLensHasNoFeatures) {
  const CameraIntrinsics camera(kSize_px, kSize_px, {90, 0, kCentre_px, 0, 90, kCentre_px, 0, 0, 1},
                                "rational_polynomial", {0.44, -2.62, 0, 0, 1.41, 0.34, -2.3, 1.27});
  ASSERT_NEAR(camera.foldRadius(), 71.0, 0.5);
  MomentExtractor extractor(camera, config(GetParam()));
  const auto at = [&](double radius_px) {
    return extractor.process(discAt(kCentre_px - 0.6 * radius_px, kCentre_px + 0.8 * radius_px).view());
  };
  const MomentFeatures inside = at(50.0), cut = at(66.0), beyond = at(88.0);
  EXPECT_TRUE(inside.valid) << inside.area;
  EXPECT_TRUE(cut.touches_border && !cut.valid);
  EXPECT_FALSE(beyond.valid);
}

}  // namespace
}  // namespace aras_visual_servo_camera::blind_area_test
