// Features of rendered views against exact polygon moments: parallel and tilted poses, with and without a lens.
#include <gtest/gtest.h>

#include <cmath>

#include "aras_visual_servo_camera/extraction/moment_extractor.hpp"
#include "aras_visual_servo_camera/moments/moments.hpp"
#include "coverage_image.hpp"
#include "usual_vision.hpp"

namespace aras_visual_servo_camera::moment_accuracy_test {
namespace {

using testing::binaryImage;
using testing::coverageImage;
using testing::Polygon;
using testing::testCamera;
using testing::View;

constexpr double kPi = 3.14159265358979323846;
constexpr double kDepth_m = 0.5;
constexpr int kPoses = 12;

// Errors read as the motion they feign at 0.5 m: the reachable accuracy of 8-bit area coverage for objects of 50 to 85
// px (rms 0.004 mm, 0.01 mm, 0.01 degree); a single view of a slender shape may be twice the rms.
constexpr double kCoverageXy_mm = 0.004, kCoverageZ_mm = 0.02, kCoverageAlpha_deg = 0.01;
// Hard edges, general rotation: rms 0.14 mm, 0.75 mm, 0.44 degree; three times that for a single view.
constexpr double kBinaryXy_mm = 0.42, kBinaryZ_mm = 2.3, kBinaryAlpha_deg = 1.3;
// Mean error of the second moments, in units of those of a pixel, m00 w^2 / 12: without the extent of the pixels they
// are off by 1, the area error above makes up to 0.4 in a single view, of either sign. Under a lens the area element
// changes within a pixel, by 0.3 of that extent at the rim of these objects, which is left out.
constexpr double kSecondMomentResidue = 0.3, kSecondMomentResidueUnderLens = 0.5;

struct Errors {
  double xy_mm = 0.0, z_mm = 0.0, alpha_deg = 0.0, mean_second = 0.0;
};

Errors worstOf(const Polygon& outline, double max_tilt, bool distorted, SegmentationMethod method, unsigned seed) {
  VisionConfig config = testing::usualVision();
  config.segmentation = method;
  const CameraIntrinsics camera = testCamera(distorted);
  MomentExtractor extractor(camera, config);
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  Errors worst;
  for (int k = 0; k < kPoses; ++k) {
    const View view{0.05 * unit(random), 0.05 * unit(random),     kDepth_m,
                    kPi * unit(random),  max_tilt * unit(random), max_tilt * unit(random)};
    const Polygon seen = testing::project(outline, view);
    const bool soft = method == SegmentationMethod::kCoverage;
    const testing::GreyImage image = soft ? coverageImage(seen, camera) : binaryImage(seen, camera);
    const MomentFeatures f = extractor.process(image.view());
    EXPECT_TRUE(f.valid) << "pose " << k << ", seed " << seed;
    if (!f.valid) continue;
    const std::vector<double> m = testing::polygonMoments(seen, 3), mu = testing::polygonCentredMoments(seen, 3);
    const double alpha = 0.5 * std::atan2(2.0 * mu[4], mu[3] - mu[5]);
    const double pixel = m[0] / (12.0 * camera.fx() * camera.fy());
    worst.xy_mm = std::max(worst.xy_mm, 1e3 * kDepth_m * std::hypot(f.xg - m[1] / m[0], f.yg - m[2] / m[0]));
    worst.z_mm = std::max(worst.z_mm, 1e3 * kDepth_m * 0.5 * std::abs(f.area / m[0] - 1.0));
    worst.alpha_deg = std::max(worst.alpha_deg, std::abs(std::remainder(f.alpha - alpha, kPi)) * 180.0 / kPi);
    worst.mean_second += (f.mu[3] + f.mu[5] - mu[3] - mu[5]) / (2.0 * pixel) / kPoses;
  }
  return worst;
}

void expectCoverageAccuracy(const Polygon& outline, double max_tilt, bool distorted, unsigned seed) {
  const Errors e = worstOf(outline, max_tilt, distorted, SegmentationMethod::kCoverage, seed);
  EXPECT_LT(e.xy_mm, kCoverageXy_mm);
  EXPECT_LT(e.z_mm, kCoverageZ_mm);
  EXPECT_LT(e.alpha_deg, kCoverageAlpha_deg);
  EXPECT_LT(std::abs(e.mean_second), distorted ? kSecondMomentResidueUnderLens : kSecondMomentResidue);
}

constexpr double kTilt_rad = 0.35;

TEST(MomentAccuracy, ParallelCoverageViewsMatchExactPolygonMoments) {
  expectCoverageAccuracy(testing::blob(0.17), 0.0, false, 11);
  expectCoverageAccuracy(testing::rectangle(0.17, 0.11), 0.0, false, 12);
  expectCoverageAccuracy(testing::triangle(0.2), 0.0, false, 13);
}

TEST(MomentAccuracy, TiltedCoverageViewsMatchExactPolygonMoments) {
  expectCoverageAccuracy(testing::blob(0.17), kTilt_rad, false, 21);
  expectCoverageAccuracy(testing::rectangle(0.17, 0.11), kTilt_rad, false, 22);
  expectCoverageAccuracy(testing::triangle(0.2), kTilt_rad, false, 23);
}

TEST(MomentAccuracy, LensDistortionIsUndoneExactly) {
  expectCoverageAccuracy(testing::blob(0.17), kTilt_rad, true, 31);
  expectCoverageAccuracy(testing::rectangle(0.17, 0.11), kTilt_rad, true, 32);
  expectCoverageAccuracy(testing::triangle(0.2), 0.0, true, 33);
}

TEST(MomentAccuracy, HardEdgedViewsStayWithinTheQuantisationOfPixels) {
  for (SegmentationMethod method :
       {SegmentationMethod::kFixed, SegmentationMethod::kOtsu, SegmentationMethod::kAdaptive}) {
    const Errors e = worstOf(testing::blob(0.17), kTilt_rad, false, method, 41);
    EXPECT_LT(e.xy_mm, kBinaryXy_mm);
    EXPECT_LT(e.z_mm, kBinaryZ_mm);
    EXPECT_LT(e.alpha_deg, kBinaryAlpha_deg);
  }
}

TEST(MomentAccuracy, CoverageWeightingIsTenTimesBetterThanAThreshold) {
  const Polygon outline = testing::blob(0.17);
  const Errors soft = worstOf(outline, 0.0, false, SegmentationMethod::kCoverage, 51);
  const Errors hard = worstOf(outline, 0.0, false, SegmentationMethod::kFixed, 51);
  EXPECT_LT(10.0 * soft.xy_mm, hard.xy_mm);
  EXPECT_LT(10.0 * soft.z_mm, hard.z_mm);
}

// An image-plane ellipse has closed forms: area pi a b, mu20 + mu02 = pi a b (a^2 + b^2) / 4, alpha its angle.
TEST(MomentAccuracy, EllipseMatchesItsClosedForms) {
  constexpr double a = 0.17, b = 0.11, angle = 0.6;
  constexpr int kCorners = 720;             // inscribed polygon: area short by (2 pi / n)^2 / 6
  constexpr double kRelative = 1e-4;        // 8-bit edges: 0.01 mm of 500 mm, twice
  constexpr double kSecondRelative = 5e-4;  // one pixel's second moments are 6e-4 of these
  const CameraIntrinsics camera = testCamera();
  MomentExtractor extractor(camera, testing::usualVision());
  const Polygon p = testing::ellipse(a, b, angle, {0.12, -0.07}, kCorners);
  const MomentFeatures f = extractor.process(coverageImage(p, camera).view());
  EXPECT_NEAR(f.area / (kPi * a * b), 1.0, kRelative);
  EXPECT_NEAR((f.mu[3] + f.mu[5]) / (kPi * a * b * (a * a + b * b) / 4.0), 1.0, kSecondRelative);
  EXPECT_NEAR(f.alpha, angle, kCoverageAlpha_deg * kPi / 180.0);
  EXPECT_NEAR(f.xg, 0.12, kCoverageXy_mm * 1e-3 / kDepth_m);
  EXPECT_NEAR(f.yg, -0.07, kCoverageXy_mm * 1e-3 / kDepth_m);
  EXPECT_TRUE(f.symmetric);
}

// Edges along the rows and columns of pixels, where the error of an edge is the same in every pixel. In units of m00
// l^3, l the longer side, with a tilt of one mrad worth 2e-5 or more.
TEST(MomentAccuracy, ThirdMomentsDoNotDependOnWhereInThePixelsTheEdgesRun) {
  constexpr double kThird = 1e-6;  // summed at the centres of pixels it would be 1.3e-5
  constexpr double kSide = 62.4, kOther = 36.6;
  const CameraIntrinsics camera = testCamera();
  VisionConfig config = testing::usualVision();
  config.order = 4;
  MomentExtractor extractor(camera, config);
  double worst = 0.0;
  for (double u = 0.0; u < 1.0; u += 0.23) {
    for (double v = 0.0; v < 1.0; v += 0.23) {
      Polygon seen;
      for (const auto& [du, dv] : {std::array<double, 2>{0.0, 0.0}, {kSide, 0.0}, {kSide, kOther}, {0.0, kOther}})
        seen.push_back({(100.0 + u + du - camera.cx()) / camera.fx(), (90.0 + v + dv - camera.cy()) / camera.fy()});
      const MomentFeatures f = extractor.process(coverageImage(seen, camera).view());
      ASSERT_TRUE(f.target_visible);
      const double unit = f.area * std::pow(kSide / camera.fx(), 3);
      for (int k : {momentIndex(3, 0), momentIndex(2, 1), momentIndex(1, 2), momentIndex(0, 3)})
        worst = std::max(worst, std::abs(f.mu[k]) / unit);  // a rectangle has none
    }
  }
  EXPECT_LT(worst, kThird);
}

// Wherever in its pixels an edge runs, noise must not seem to move it: as much as it adds outside, it takes away
// inside.
TEST(MomentAccuracy, NoiseMovesNoEdgeWhereverInItsPixelsItRuns) {
  constexpr double kSigma = 5.0, kSide = 60.0;
  constexpr int kImages = 300;
  // 4 x 60 px of edge, about three pixels across with the deviation 5 / 210, in the mean of all images; four of these.
  const double allowed_px = 4.0 * std::sqrt(4.0 * kSide * 3.0) * kSigma / 210.0 / std::sqrt(1.0 * kImages);
  const CameraIntrinsics camera = testCamera();
  MomentExtractor extractor(camera, testing::usualVision());
  std::mt19937 random(62);
  for (double phase : {0.0, 0.2, 0.4, 0.6, 0.8}) {
    Polygon seen;
    for (const auto& [du, dv] : {std::array<double, 2>{0.0, 0.0}, {kSide, 0.0}, {kSide, kSide}, {0.0, kSide}})
      seen.push_back(
          {(100.5 + phase + du - camera.cx()) / camera.fx(), (90.5 + phase + dv - camera.cy()) / camera.fy()});
    const testing::GreyImage clean = coverageImage(seen, camera);
    const double exact = extractor.process(clean.view()).area;
    double off_px = 0.0;
    for (int k = 0; k < kImages; ++k) {
      testing::GreyImage image = clean;
      testing::addNoise(kSigma, &random, &image);
      off_px += (extractor.process(image.view()).area - exact) * camera.fx() * camera.fy() / kImages;
    }
    EXPECT_LT(std::abs(off_px), allowed_px) << phase;
  }
}

TEST(MomentAccuracy, NoiseMovesTheFeaturesByLittleAndWithoutBias) {
  // sigma 4 of 210 levels on some 4 x 210 edge pixels: relative area error sqrt(840) 0.019 / 3000 px = 1.8e-4, in z
  // half of it, 0.05 mm; the bias of clipped weights cancels between the two sides of the edge.
  constexpr double kSigma = 4.0, kSingle_mm = 0.3, kMean_mm = 0.08;
  constexpr int kImages = 12;
  const CameraIntrinsics camera = testCamera();
  const Polygon seen = testing::project(testing::blob(0.17), {0.02, -0.01, kDepth_m, 0.5, 0.1, -0.2});
  const double exact = testing::polygonMoments(seen, 0)[0];
  const testing::GreyImage clean = coverageImage(seen, camera);
  MomentExtractor extractor(camera, testing::usualVision());
  std::mt19937 random(61);
  double mean_mm = 0.0;
  for (int k = 0; k < kImages; ++k) {
    testing::GreyImage image = clean;
    testing::addNoise(kSigma, &random, &image);
    const MomentFeatures f = extractor.process(image.view());
    ASSERT_TRUE(f.valid);
    EXPECT_EQ(f.components, 1);
    const double z_mm = 1e3 * kDepth_m * 0.5 * (f.area / exact - 1.0);
    EXPECT_LT(std::abs(z_mm), kSingle_mm);
    mean_mm += z_mm / kImages;
  }
  EXPECT_LT(std::abs(mean_mm), kMean_mm);
}

}  // namespace
}  // namespace aras_visual_servo_camera::moment_accuracy_test
