// Centroids of several objects, which is which, and what corners and centroids have in common. Points that are cut,
// jump, are alone or beside equal ones, and references that name no points.
#include <gtest/gtest.h>

#include <cmath>

#include "aras_visual_servo_camera/config/errors.hpp"
#include "aras_visual_servo_camera/extraction/moment_extractor.hpp"
#include "coverage_image.hpp"
#include "dot_views.hpp"
#include "point_views.hpp"
#include "usual_vision.hpp"

namespace aras_visual_servo_camera::points_test {
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

constexpr double kDeg = 3.14159265358979323846 / 180.0, kDepth_m = 0.5;
const CameraIntrinsics kCamera = testing::testCamera();

View turnedBy(double degrees, double x_m = 0.0) { return {x_m, 0.0, kDepth_m, degrees * kDeg, 0.0, 0.0}; }

const MomentFeatures& look(MomentExtractor* extractor, const View& view, const Polygon& dots) {
  return extractor->process(dotsSeenFrom(view, kCamera, dots).image.view());
}

Polygon truth(const View& view, const Polygon& dots) { return dotsSeenFrom(view, kCamera, dots).truth; }

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
  MomentExtractor extractor(kCamera, withPoints(PointSource::kBlobs, 4));
  const View view{0.02, 0.01, 0.5, 0.4, 0.2, -0.1};
  double area = 0.0;
  for (const Point2& dot : kQuad)
    area += testing::polygonMoments(testing::project(testing::ellipse(0.012, 0.012, 0.0, dot, 48), view), 0)[0];
  const MomentFeatures f = look(&extractor, view, kQuad);
  constexpr double kGreySteps = 1e-3;  // edges of four dots of 60 pixels, in steps of 1 / 210
  EXPECT_NEAR(f.area / area, 1.0, kGreySteps);
  EXPECT_EQ(f.components, 4);
}

TEST(Blobs, FewerThanWantedAreNoTarget) {
  MomentExtractor extractor(kCamera, withPoints(PointSource::kBlobs, 4));
  const View view{0.0, 0.0, 0.5, 0.0, 0.0, 0.0};
  extractor.setReference(0.5, look(&extractor, view, kQuad));
  Polygon three(kQuad.begin(), kQuad.end() - 1);
  const MomentFeatures f = look(&extractor, view, three);
  EXPECT_FALSE(f.target_visible);
  EXPECT_TRUE(f.point_x.empty());
  EXPECT_EQ(f.components, 3);
}

TEST(Blobs, AreFollowedPastAnotherObject) {
  MomentExtractor extractor(kCamera, withPoints(PointSource::kBlobs, 4));
  const View start{0.0, 0.0, 0.5, 0.0, 0.0, 0.0};
  extractor.setReference(0.5, look(&extractor, start, kQuad));
  for (int step = 0; step <= 30; ++step) {
    Polygon dots = kQuad;
    dots.push_back({-0.15 + 0.01 * step, 0.0});  // a fifth, equal one, passes between them
    const DotView seen = dotsSeenFrom({0.001 * step, 0.0, 0.5, 0.03 * step, 0.0, 0.0}, kCamera, dots);
    const MomentFeatures f = extractor.process(seen.image.view());
    if (f.point_x.empty()) continue;  // two of them touch
    EXPECT_LT(farthest_px(f, Polygon(seen.truth.begin(), seen.truth.end() - 1)), kCorner_px) << step;
  }
  EXPECT_TRUE(extractor.features().valid);
}

TEST(Blobs, MoreThanWantedNeedToBeClearlySmaller) {
  Polygon five = kQuad;
  five.push_back({0.0, 0.09});
  MomentExtractor extractor(kCamera, withPoints(PointSource::kBlobs, 4));
  const View view{0.0, 0.0, 0.5, 0.0, 0.0, 0.0};
  EXPECT_FALSE(look(&extractor, view, five).target_visible);
  DotView seen = dotsSeenFrom(view, kCamera, kQuad, 0.016);
  testing::drawCoverage(testing::project(testing::ellipse(0.012, 0.012, 0.0, five.back(), 48), view), kCamera,
                        testing::kObjectGrey, &seen.image);
  EXPECT_LT(farthest_px(extractor.process(seen.image.view()), seen.truth), kCorner_px);
}

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

TEST(Points, SurviveAnotherCameraInfo) {
  const CameraIntrinsics lens = testing::testCamera(true);
  MomentExtractor extractor(kCamera, withPoints(PointSource::kCorners, 4));
  const Polygon truth = testing::project(kQuad, {0.0, 0.0, 0.5, 0.3, 0.0, 0.0});
  extractor.setReference(0.5, extractor.process(testing::coverageImage(truth, kCamera).view()));
  extractor.setIntrinsics(lens);
  const Polygon turned = testing::project(kQuad, {0.0, 0.0, 0.5, 3.0, 0.0, 0.0});
  EXPECT_LT(farthest_px(extractor.process(testing::coverageImage(turned, lens).view()), turned), kCorner_px);
}

TEST(Blobs, OneThatABorderCutsIsNoneOfThePoints) {
  // A large dot in the middle of a border: half of it is more than a speck.
  constexpr double kRadius_m = 0.02;
  for (const auto& [u, v] : {std::pair(0, 120), std::pair(319, 120), std::pair(160, 0), std::pair(160, 239)}) {
    MomentExtractor extractor(kCamera, withPoints(PointSource::kBlobs, 2));
    const auto at = [](double u_px, double v_px) {
      return testing::Point2{kDepth_m * (u_px - kCamera.cx()) / kCamera.fx(),
                             kDepth_m * (v_px - kCamera.cy()) / kCamera.fy()};
    };
    const testing::Point2 middle = at(160, 120);
    const double inward = 0.8;
    const MomentFeatures whole = extractor.process(
        dotsSeenFrom(turnedBy(0), kCamera, {middle, at(160 + inward * (u - 160), 120 + inward * (v - 120))}, kRadius_m)
            .image.view());
    EXPECT_TRUE(whole.valid) << u << " " << v;
    const MomentFeatures cut =
        extractor.process(dotsSeenFrom(turnedBy(0), kCamera, {middle, at(u, v)}, kRadius_m).image.view());
    EXPECT_EQ(cut.components, 2) << u << " " << v;
    EXPECT_FALSE(cut.target_visible || cut.valid) << u << " " << v;
  }
}

TEST(Blobs, ThatJumpedAreFoundAgainByTheirPattern) {
  MomentExtractor extractor(kCamera, withPoints(PointSource::kBlobs, 4));
  extractor.setReference(kDepth_m, look(&extractor, turnedBy(0), kQuad));
  for (const double degrees : {70.0, 140.0, 210.0}) {
    const View view = turnedBy(degrees, 0.1);
    EXPECT_LT(farthest_px(look(&extractor, view, kQuad), truth(view, kQuad)), kCorner_px) << degrees;
  }
}

TEST(Blobs, OneAloneIsThePointWhereverItIs) {
  MomentExtractor extractor(kCamera, withPoints(PointSource::kBlobs, 1));
  extractor.setReference(kDepth_m, look(&extractor, turnedBy(0), {{0.0, 0.0}}));
  for (const testing::Point2& dot : {testing::Point2{0.2, 0.1}, {-0.2, 0.1}, {0.0, -0.15}}) {
    extractor.forgetPrevious();
    const MomentFeatures f = look(&extractor, turnedBy(0), {dot});
    EXPECT_TRUE(f.valid);
    EXPECT_LT(farthest_px(f, truth(turnedBy(0), {dot})), kCorner_px);
  }
}

TEST(Blobs, OfTwoEqualOnesTheOneFollowedIsThePoint) {
  MomentExtractor extractor(kCamera, withPoints(PointSource::kBlobs, 1));
  const Polygon one{{-0.1, 0.0}}, two{{-0.1, 0.01}, {0.1, 0.0}};
  EXPECT_FALSE(look(&extractor, turnedBy(0), two).target_visible) << "before there is a reference, nothing tells which";
  extractor.setReference(kDepth_m, look(&extractor, turnedBy(0), one));
  const MomentFeatures f = look(&extractor, turnedBy(0), two);
  EXPECT_LT(farthest_px(f, truth(turnedBy(0), {two[0]})), kCorner_px);
}

TEST(Points, KeepTheirOrderUntilTheReferenceNamesNone) {
  const View turned = turnedBy(120);
  const Polygon quad = testing::project(kQuad, turned);
  const auto image = testing::coverageImage(quad, kCamera);
  MomentExtractor extractor(kCamera, withPoints(PointSource::kCorners, 4));
  const auto first = [&] {
    const MomentFeatures& f = extractor.process(image.view());
    EXPECT_EQ(f.point_x.size(), 4u);
    return f.point_x.empty() ? 0.0 : f.point_x[0];
  };
  const auto teach = [&] {
    const auto start = testing::coverageImage(testing::project(kQuad, turnedBy(0)), kCamera);
    extractor.clearReference();
    extractor.setReference(kDepth_m, extractor.process(start.view()));
    extractor.forgetPrevious();
  };
  const double from_top_left = first();
  teach();
  EXPECT_NEAR(first(), quad[0].x, kCorner_px / kCamera.fx());
  EXPECT_GT(std::abs(quad[0].x - from_top_left), 0.05) << "another corner";
  extractor.setReference(kDepth_m, 0.02, 0.0);
  EXPECT_EQ(first(), from_top_left);
  teach();
  extractor.clearReference();
  EXPECT_EQ(first(), from_top_left);
}

TEST(Points, OfAReferenceAreAsManyInXAsInYAndFinite) {
  MomentExtractor extractor(kCamera, withPoints(PointSource::kBlobs, 4));
  const MomentFeatures whole = look(&extractor, turnedBy(0), kQuad);
  MomentFeatures f = whole;
  f.point_y.pop_back();
  EXPECT_THROW(extractor.setReference(kDepth_m, f), ShapeError);
  f = whole;
  f.point_x.pop_back();
  EXPECT_THROW(extractor.setReference(kDepth_m, f), ShapeError);
  for (const double bad : {MomentFeatures::kNone, double{INFINITY}}) {
    f = whole;
    f.point_x[3] = bad;
    EXPECT_THROW(extractor.setReference(kDepth_m, f), ParameterError);
    f = whole;
    f.point_y[0] = bad;
    EXPECT_THROW(extractor.setReference(kDepth_m, f), ParameterError);
  }
  EXPECT_FALSE(extractor.reference().has_value());
  extractor.setReference(kDepth_m, whole);
  EXPECT_TRUE(extractor.reference().has_value());
}

TEST(Corners, OfAFewPixelsOrBeyondTheFoldOfTheLensAreNotGiven) {
  VisionConfig config = withPoints(PointSource::kCorners, 4);
  config.min_area_px = 1;
  const CameraIntrinsics folded(320, 240, {195.05, 0, 159.5, 0, 195.05, 119.5, 0, 0, 1}, "plumb_bob", {-0.8, 0, 0, 0});
  MomentExtractor extractor(kCamera, config), bent(folded, config);
  const auto points = [](MomentExtractor* e, int u0, int v0, int side) {
    testing::GreyImage image(320, 240, testing::kBackgroundGrey);
    for (int v = v0; v < v0 + side; ++v)
      for (int u = u0; u < u0 + side; ++u) image.at(u, v) = testing::kObjectGrey;
    return e->process(image.view()).point_x.size();
  };
  EXPECT_EQ(points(&extractor, 20, 20, 3), 0u);
  EXPECT_EQ(points(&extractor, 20, 20, 40), 4u);
  EXPECT_EQ(points(&bent, 140, 100, 40), 4u);
  EXPECT_EQ(points(&bent, 20, 20, 40), 0u);
}

}  // namespace
}  // namespace aras_visual_servo_camera::points_test
