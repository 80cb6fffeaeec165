#include "aras_visual_servo_camera/moments/moment_features.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "aras_visual_servo_camera/extraction/moment_extractor.hpp"
#include "aras_visual_servo_camera/moments/moments.hpp"
#include "coverage_image.hpp"
#include "text_of.hpp"
#include "usual_vision.hpp"

namespace aras_visual_servo_camera::moment_features_test {
namespace {

using testing::Polygon;

constexpr double kRounding = 1e-12;  // relative; a few tens of operations
constexpr FeatureBuilder::View kSeen{true, false, 1};

Polygon seenFrom(double depth_m, double yaw = 0.4) {
  return testing::project(testing::blob(0.14), {0.03, -0.02, depth_m, yaw, 0.1, 0.2});
}

FeatureBuilder builder() { return FeatureBuilder(3, 0.03, 0.01); }

TEST(ThirdMoments, RotatedMatchesTheMomentsOfTheRotatedPolygon) {
  const Polygon p = seenFrom(0.5);
  for (double angle : {0.3, 1.9, -2.7}) {
    Polygon q;
    for (const auto& a : p)
      q.push_back({std::cos(angle) * a.x + std::sin(angle) * a.y, -std::sin(angle) * a.x + std::cos(angle) * a.y});
    const auto mu = testing::polygonCentredMoments(p, 3), expected = testing::polygonCentredMoments(q, 3);
    const ThirdMoments t{mu[6], mu[7], mu[8], mu[9]}, r = rotated(t, angle);
    const double scale = std::sqrt(dot(t, t));
    for (int k = 0; k < 4; ++k) EXPECT_NEAR(r[k], expected[6 + k], kRounding * scale);
    EXPECT_NEAR(dot(r, r), dot(t, t), kRounding * dot(t, t));
  }
}

TEST(MomentFeatures, FollowTheirDefinitions) {
  FeatureBuilder b = builder();
  const auto m_star = testing::polygonMoments(seenFrom(0.5), 3), m = testing::polygonMoments(seenFrom(0.7, 0.9), 3);
  b.setReference(0.5, b.build(kSeen, m_star));
  const MomentFeatures f = b.build(kSeen, m);
  const auto mu = testing::polygonCentredMoments(seenFrom(0.7, 0.9), 3);
  EXPECT_TRUE(f.valid && f.has_reference && f.target_visible);
  EXPECT_EQ(f.area, m[0]);
  EXPECT_NEAR(f.xg, m[1] / m[0], kRounding);
  EXPECT_NEAR(f.yg, m[2] / m[0], kRounding);
  const double an = 0.5 * std::sqrt(m_star[0] / m[0]);
  EXPECT_NEAR(f.an, an, kRounding);
  EXPECT_NEAR(f.xn, an * f.xg, kRounding);
  EXPECT_NEAR(f.yn, an * f.yg, kRounding);
  EXPECT_EQ(f.z_star_m, 0.5);
  EXPECT_EQ(f.area_star, m_star[0]);
  for (int k = 0; k < momentCount(3); ++k) EXPECT_NEAR(f.mu[k], mu[k], kRounding * m[0]) << f.moment_names[k];
  EXPECT_EQ(f.moment_names, (std::vector<std::string>{"00", "10", "01", "20", "11", "02", "30", "21", "12", "03"}));
}

TEST(MomentFeatures, AsymmetryDoesNotDependOnSizeOrAngle) {
  constexpr double kRelative = 1e-9;  // rounding of third moments of a small shape
  FeatureBuilder b = builder();
  double first = 0.0;
  for (double size : {0.001, 0.1, 10.0}) {
    for (double angle : {0.0, 1.0, 2.0}) {
      const Polygon p = testing::project(testing::triangle(size), {0.0, 0.0, 1.0, angle, 0.0, 0.0});
      const double asymmetry = b.build(kSeen, testing::polygonMoments(p, 3)).asymmetry;
      if (first == 0.0) first = asymmetry;
      EXPECT_NEAR(asymmetry / first, 1.0, kRelative) << size;
    }
  }
  EXPECT_GT(first, 0.1);
}

TEST(MomentFeatures, NothingInViewIsAValue) {
  FeatureBuilder b = builder();
  const MomentFeatures f = b.build({false, false, 0}, {});
  EXPECT_FALSE(f.target_visible || f.valid || f.touches_border || f.has_reference);
  for (double x : {f.area, f.xg, f.yg, f.alpha, f.xn, f.yn, f.an, f.z_star_m, f.area_star, f.asymmetry})
    EXPECT_TRUE(std::isnan(x));
  EXPECT_TRUE(f.m.empty() && f.mu.empty());
}

TEST(MomentFeatures, CutObjectIsVisibleButNotValid) {
  FeatureBuilder b = builder();
  const MomentFeatures f = b.build({true, true, 1}, testing::polygonMoments(seenFrom(0.5), 3));
  EXPECT_TRUE(f.target_visible && f.touches_border);
  EXPECT_FALSE(f.valid);
  EXPECT_THROW(b.setReference(0.5, f), DegenerateFeature);
}

TEST(MomentFeatures, NumbersOfAReferenceAreChecked) {
  FeatureBuilder b = builder();
  const double nan = MomentFeatures::kNone;
  EXPECT_THROW(b.setReference({0.0, 0.1, 0.0}), ParameterError);
  EXPECT_THROW(b.setReference({0.5, -0.1, 0.0}), ParameterError);
  EXPECT_THROW(b.setReference({nan, 0.1, 0.0}), ParameterError);
  EXPECT_THROW(b.setReference({0.5, 0.1, nan}), ParameterError);
  EXPECT_FALSE(b.reference().has_value());
  const std::string faults = testing::textOf<ParameterError>([&] { b.setReference({-1.0, nan, 0.0}); });
  for (const char* key : {"z_star_m", "area_star"}) EXPECT_NE(faults.find(key), std::string::npos) << faults;
}

TEST(MomentFeatures, ReferenceByNumbersLearnsTheBranchFromTheFirstView) {
  FeatureBuilder b = builder();
  const auto at = [&](double yaw) { return testing::polygonMoments(seenFrom(0.5, yaw), 3); };
  const double alpha = b.build(kSeen, at(0.4)).alpha;
  for (double offset : {0.0, 3.14159265358979}) {  // either branch may be named
    b.setReference({0.5, 0.07, alpha + offset});
    EXPECT_LT(std::abs(std::remainder(b.build(kSeen, at(0.5)).alpha - alpha - offset, 2 * 3.14159265358979)), 0.5);
    // two radians on the branch is still the one learnt
    EXPECT_LT(std::abs(std::remainder(b.build(kSeen, at(2.9)).alpha - alpha - offset - 2.5, 2 * 3.14159265358979)),
              0.5);
  }
}

TEST(MomentFeatures, ClearedReferenceLeavesNoTrace) {
  FeatureBuilder b = builder();
  const auto m = testing::polygonMoments(seenFrom(0.5), 3);
  b.setReference(0.5, b.build(kSeen, m));
  b.clearReference();
  const MomentFeatures f = b.build(kSeen, m);
  EXPECT_FALSE(f.has_reference);
  EXPECT_TRUE(std::isnan(f.an));
}

TEST(MomentExtractor, RepeatsAreBitIdentical) {
  const CameraIntrinsics camera = testing::testCamera(true);
  std::vector<testing::GreyImage> images;
  std::mt19937 random(9);
  for (double depth : {0.5, 0.6, 0.7}) {
    images.push_back(testing::coverageImage(seenFrom(depth), camera));
    testing::addNoise(3.0, &random, &images.back());
  }
  std::vector<std::vector<double>> runs;
  for (int run = 0; run < 3; ++run) {
    MomentExtractor extractor(camera, testing::usualVision());
    std::vector<double> bits;
    for (const auto& image : images) {
      const MomentFeatures f = extractor.process(image.view());
      bits.insert(bits.end(), f.m.begin(), f.m.end());
      bits.insert(bits.end(), f.mu.begin(), f.mu.end());
      bits.push_back(f.alpha);
    }
    runs.push_back(bits);
  }
  ASSERT_EQ(runs[0].size(), 63u);
  for (int run : {1, 2}) EXPECT_EQ(std::memcmp(runs[0].data(), runs[run].data(), runs[0].size() * sizeof(double)), 0);
}

TEST(MomentExtractor, OrderFiveGivesTwentyOneMoments) {
  VisionConfig config = testing::usualVision();
  config.order = 5;
  const CameraIntrinsics camera = testing::testCamera();
  MomentExtractor extractor(camera, config);
  const MomentFeatures f = extractor.process(testing::coverageImage(seenFrom(0.5), camera).view());
  EXPECT_EQ(f.m.size(), 21u);
  EXPECT_EQ(f.mu.size(), 21u);
  EXPECT_EQ(f.moment_names.back(), "05");
}

TEST(MomentExtractor, ImageOfAnotherSizeIsAShapeError) {
  MomentExtractor extractor(testing::testCamera(), testing::usualVision());
  EXPECT_THROW(extractor.process(testing::GreyImage(160, 120, 200).view()), ShapeError);
}

TEST(MomentExtractor, ObjectBeyondTheFoldOfTheLensIsNotValid) {
  const CameraIntrinsics camera(320, 240, {195.05, 0, 159.5, 0, 195.05, 119.5, 0, 0, 1}, "plumb_bob", {-0.8, 0, 0, 0});
  testing::GreyImage image(320, 240, testing::kBackgroundGrey);
  for (int v = 20; v < 40; ++v)
    for (int u = 20; u < 60; ++u) image.at(u, v) = testing::kObjectGrey;
  MomentExtractor extractor(camera, testing::usualVision());
  EXPECT_FALSE(extractor.process(image.view()).valid);
}

TEST(MomentExtractor, OnePixelHasACentroidButNoOrientation) {
  testing::GreyImage image(320, 240, testing::kBackgroundGrey);
  image.at(200, 50) = testing::kObjectGrey;
  VisionConfig config = testing::usualVision();
  config.min_area_px = 1;
  const CameraIntrinsics camera = testing::testCamera();
  MomentExtractor extractor(camera, config);
  const MomentFeatures f = extractor.process(image.view());
  EXPECT_TRUE(f.target_visible);
  EXPECT_FALSE(f.valid);
  EXPECT_NEAR(f.xg, (200 - camera.cx()) / camera.fx(), kRounding);
  EXPECT_TRUE(std::isnan(f.alpha));
}

TEST(MomentExtractor, NewIntrinsicsKeepTheReference) {
  const CameraIntrinsics camera = testing::testCamera(), lens = testing::testCamera(true);
  constexpr double kDepth = 2e-5;  // relative area error of a coverage image
  MomentExtractor extractor(camera, testing::usualVision());
  extractor.setReference(0.5, extractor.process(testing::coverageImage(seenFrom(0.5), camera).view()));
  extractor.setIntrinsics(lens);
  EXPECT_FALSE(extractor.features().target_visible);
  const MomentFeatures f = extractor.process(testing::coverageImage(seenFrom(0.5), lens).view());
  EXPECT_NEAR(f.an, 0.5, 2 * kDepth);
}

}  // namespace
}  // namespace aras_visual_servo_camera::moment_features_test
