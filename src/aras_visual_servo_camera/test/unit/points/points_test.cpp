// Centroids of several objects, which is which, and what corners and centroids have in common.
#include <gtest/gtest.h>

#include <cmath>

#include "aras_visual_servo_camera/config/errors.hpp"
#include "aras_visual_servo_camera/extraction/moment_extractor.hpp"
#include "coverage_image.hpp"
#include "dot_views.hpp"
#include "point_views.hpp"
#include "usual_vision.hpp"

namespace aras_visual_servo_camera {
namespace {

using testing::dotsSeenFrom;
using testing::DotView;
using testing::farthest_px;
using testing::GreyImage;
using testing::kCorner_px;
using testing::kQuad;
using testing::Point2;
using testing::Polygon;
using testing::View;
using testing::withPoints;

constexpr double kDeg = 3.14159265358979323846 / 180.0;

MomentExtractor withCorners(const CameraIntrinsics& camera) {
  return MomentExtractor(camera, withPoints(PointSource::kCorners, 4));
}

class Dots : public ::testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(Blobs, Dots, ::testing::Values(false, true));

TEST_P(Dots, KeepTheOrderOfTheReferenceAtAnyAngle) {
  const CameraIntrinsics camera = testing::testCamera(GetParam());
  MomentExtractor extractor(camera, withPoints(PointSource::kBlobs, 4));
  const DotView reference = dotsSeenFrom({0.0, 0.0, 0.5, 0.0, 0.0, 0.0}, camera, kQuad);
  extractor.setReference(0.5, extractor.process(reference.image.view()));
  EXPECT_LT(farthest_px(extractor.features(), reference.truth), kCorner_px);
  for (int degrees = 0; degrees < 360; degrees += 30) {
    extractor.forgetPrevious();
    const DotView seen = dotsSeenFrom({0.02, 0.01, 0.5, degrees * kDeg, 0.3, -0.2}, camera, kQuad);
    const MomentFeatures& f = extractor.process(seen.image.view());
    EXPECT_TRUE(f.valid);
    EXPECT_LT(farthest_px(f, seen.truth), kCorner_px) << degrees;
  }
}

TEST(Blobs, MomentsAreThoseOfAllTogether) {
  const CameraIntrinsics camera = testing::testCamera();
  MomentExtractor extractor(camera, withPoints(PointSource::kBlobs, 4));
  const View view{0.02, 0.01, 0.5, 0.4, 0.2, -0.1};
  double area = 0.0;
  for (const Point2& dot : kQuad)
    area += testing::polygonMoments(testing::project(testing::ellipse(0.012, 0.012, 0.0, dot, 48), view), 0)[0];
  const MomentFeatures& f = extractor.process(dotsSeenFrom(view, camera, kQuad).image.view());
  constexpr double kGreySteps = 1e-3;  // edges of four dots of 60 pixels, in steps of 1 / 210
  EXPECT_NEAR(f.area / area, 1.0, kGreySteps);
  EXPECT_EQ(f.components, 4);
}

TEST(Blobs, FewerThanWantedAreNoTarget) {
  const CameraIntrinsics camera = testing::testCamera();
  MomentExtractor extractor(camera, withPoints(PointSource::kBlobs, 4));
  const View view{0.0, 0.0, 0.5, 0.0, 0.0, 0.0};
  extractor.setReference(0.5, extractor.process(dotsSeenFrom(view, camera, kQuad).image.view()));
  Polygon three(kQuad.begin(), kQuad.end() - 1);
  const MomentFeatures f = extractor.process(dotsSeenFrom(view, camera, three).image.view());
  EXPECT_FALSE(f.target_visible);
  EXPECT_TRUE(f.point_x.empty());
  EXPECT_EQ(f.components, 3);
}

TEST(Blobs, AreFollowedPastAnotherObject) {
  const CameraIntrinsics camera = testing::testCamera();
  MomentExtractor extractor(camera, withPoints(PointSource::kBlobs, 4));
  const View start{0.0, 0.0, 0.5, 0.0, 0.0, 0.0};
  extractor.setReference(0.5, extractor.process(dotsSeenFrom(start, camera, kQuad).image.view()));
  for (int step = 0; step <= 30; ++step) {
    Polygon dots = kQuad;
    dots.push_back({-0.15 + 0.01 * step, 0.0});  // a fifth, equal one, passes between them
    const DotView seen = dotsSeenFrom({0.001 * step, 0.0, 0.5, 0.03 * step, 0.0, 0.0}, camera, dots);
    const MomentFeatures f = extractor.process(seen.image.view());
    if (f.point_x.empty()) continue;  // two of them touch
    EXPECT_LT(farthest_px(f, Polygon(seen.truth.begin(), seen.truth.end() - 1)), kCorner_px) << step;
  }
  EXPECT_TRUE(extractor.features().valid);
}

TEST(Blobs, MoreThanWantedNeedToBeClearlySmaller) {
  const CameraIntrinsics camera = testing::testCamera();
  Polygon five = kQuad;
  five.push_back({0.0, 0.09});
  MomentExtractor extractor(camera, withPoints(PointSource::kBlobs, 4));
  const View view{0.0, 0.0, 0.5, 0.0, 0.0, 0.0};
  EXPECT_FALSE(extractor.process(dotsSeenFrom(view, camera, five).image.view()).target_visible);
  DotView seen = dotsSeenFrom(view, camera, kQuad, 0.016);
  testing::drawCoverage(testing::project(testing::ellipse(0.012, 0.012, 0.0, five.back(), 48), view), camera,
                        testing::kObjectGrey, &seen.image);
  EXPECT_LT(farthest_px(extractor.process(seen.image.view()), seen.truth), kCorner_px);
}

// --- corners and blobs
// ------------------------------------------------------------------------------------------------------------

TEST(Points, SameImagesGiveTheSameBits) {
  const CameraIntrinsics camera = testing::testCamera(true);
  for (const PointSource source : {PointSource::kCorners, PointSource::kBlobs}) {
    std::vector<double> first;
    for (int run = 0; run < 2; ++run) {
      MomentExtractor extractor(camera, withPoints(source, 4));
      std::vector<double> all;
      for (int step = 0; step < 5; ++step) {
        const View view{0.0, 0.0, 0.5, 0.2 * step, 0.2, 0.1};
        const GreyImage image = source == PointSource::kBlobs
                                    ? dotsSeenFrom(view, camera, kQuad).image
                                    : testing::coverageImage(testing::project(kQuad, view), camera);
        const MomentFeatures f = extractor.process(image.view());
        if (step == 0) extractor.setReference(0.5, f);
        all.insert(all.end(), f.point_x.begin(), f.point_x.end());
        all.insert(all.end(), f.point_y.begin(), f.point_y.end());
      }
      EXPECT_EQ(all.size(), 40u);
      if (run == 0) first = all;
      EXPECT_EQ(all, first);
    }
  }
}

TEST(Points, ReferenceNeedsTheConfiguredNumber) {
  const CameraIntrinsics camera = testing::testCamera();
  MomentExtractor without(camera, testing::usualVision()), with = withCorners(camera);
  const GreyImage image = testing::coverageImage(testing::project(kQuad, {0.0, 0.0, 0.5, 0.3, 0.0, 0.0}), camera);
  MomentFeatures f = without.process(image.view());
  EXPECT_TRUE(f.point_x.empty());
  EXPECT_THROW(with.setReference(0.5, f), ShapeError);
  f = with.process(image.view());
  f.point_x[2] = MomentFeatures::kNone;
  EXPECT_THROW(with.setReference(0.5, f), ParameterError);
  EXPECT_FALSE(with.reference().has_value());
}

TEST(Points, SurviveAnotherCameraInfo) {
  const CameraIntrinsics camera = testing::testCamera(), lens = testing::testCamera(true);
  MomentExtractor extractor = withCorners(camera);
  const Polygon truth = testing::project(kQuad, {0.0, 0.0, 0.5, 0.3, 0.0, 0.0});
  extractor.setReference(0.5, extractor.process(testing::coverageImage(truth, camera).view()));
  extractor.setIntrinsics(lens);
  const Polygon turned = testing::project(kQuad, {0.0, 0.0, 0.5, 3.0, 0.0, 0.0});
  EXPECT_LT(farthest_px(extractor.process(testing::coverageImage(turned, lens).view()), turned), kCorner_px);
}

}  // namespace
}  // namespace aras_visual_servo_camera
