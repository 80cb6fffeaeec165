// ViSP's own polygon moments and features as a second opinion, where they are right.
#include <gtest/gtest.h>
#include <visp3/core/vpMomentAlpha.h>
#include <visp3/core/vpMomentCommon.h>
#include <visp3/core/vpMomentObject.h>
#include <visp3/core/vpPoint.h>

#include <algorithm>
#include <cmath>

#include "aras_visual_servo_camera/moments/moment_features.hpp"
#include "aras_visual_servo_camera/moments/moments.hpp"
#include "coverage_image.hpp"

namespace aras_visual_servo_camera {
namespace {

using testing::Polygon;

constexpr double kRounding = 1e-9;  // relative; ViSP sums powers of coordinates of order 1 without centring
constexpr FeatureBuilder::View kSeen{true, false, 1};

// ViSP wants polygons closed and clockwise on the screen (y down), which a positive area in these axes means.
vpMomentObject vispObject(Polygon polygon) {
  double twice_area = 0.0;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const auto &a = polygon[k], &b = polygon[(k + 1) % polygon.size()];
    twice_area += a.x * b.y - b.x * a.y;
  }
  if (twice_area < 0.0) std::reverse(polygon.begin(), polygon.end());
  std::vector<vpPoint> points;
  for (std::size_t k = 0; k <= polygon.size(); ++k) {
    vpPoint p;
    p.set_x(polygon[k % polygon.size()].x);
    p.set_y(polygon[k % polygon.size()].y);
    points.push_back(p);
  }
  vpMomentObject object(6);  // vpMomentCommon wants 5, and 5 is wrong in places
  object.setType(vpMomentObject::DENSE_POLYGON);
  object.fromVector(points);
  return object;
}

const std::vector<testing::View> kViews{{0.02, -0.01, 0.5, 0.4, 0.0, 0.0}, {-0.05, 0.04, 0.6, -2.0, 0.3, -0.2}};

TEST(VispOracle, PolygonMomentsAgree) {
  for (const auto& view : kViews) {
    const Polygon p = testing::project(testing::blob(0.2), view);
    vpMomentObject object = vispObject(p);
    const auto m = testing::polygonMoments(p, 3);
    for (int i = 0; i <= 3; ++i)
      for (int j = 0; i + j <= 3; ++j) EXPECT_NEAR(object.get(i, j), m[momentIndex(i, j)], kRounding * m[0]);
  }
}

TEST(VispOracle, NormalisedFeaturesAndAlphaAgreeWithMomentCommon) {
  const Polygon goal = testing::project(testing::triangle(0.3), {0.0, 0.0, 0.5, 0.2, 0.0, 0.0});
  vpMomentObject goal_object = vispObject(goal);
  FeatureBuilder builder(3, 0.03, 0.01);
  builder.setReference(0.5, builder.build(kSeen, testing::polygonMoments(goal, 3)));
  vpMomentCommon common(vpMomentCommon::getSurface(goal_object), vpMomentCommon::getMu3(goal_object),
                        vpMomentCommon::getAlpha(goal_object), 0.5);
  for (const auto& view : kViews) {
    const Polygon seen = testing::project(testing::triangle(0.3), view);
    vpMomentObject object = vispObject(seen);
    common.updateAll(object);
    const MomentFeatures f = builder.build(kSeen, testing::polygonMoments(seen, 3));
    bool found = false;
    const auto& centre = common.get("vpMomentGravityCenterNormalized", found).get();
    ASSERT_TRUE(found);
    EXPECT_NEAR(f.xn, centre[0], kRounding);
    EXPECT_NEAR(f.yn, centre[1], kRounding);
    EXPECT_NEAR(f.an, common.get("vpMomentAreaNormalized", found).get()[0], kRounding);
    const auto& alpha = dynamic_cast<const vpMomentAlpha&>(common.get("vpMomentAlpha", found));
    ASSERT_FALSE(alpha.is_symmetric());  // large enough for ViSP's absolute threshold
    EXPECT_NEAR(std::remainder(f.alpha - alpha.get(), 2.0 * 3.14159265358979323846), 0.0, kRounding);
  }
}

TEST(VispOracle, AlphaOfASmallObjectIsResolvedWhereVispIsSilentlyWrong) {
  // The reason for an alpha of our own: at 12 px ViSP calls an asymmetric triangle symmetric.
  constexpr double kPi = 3.14159265358979323846;
  const auto seen = [](double yaw) {
    return testing::project(testing::triangle(0.03), {0.0, 0.0, 0.5, yaw, 0.0, 0.0});
  };
  FeatureBuilder builder(3, 0.03, 0.01);
  builder.setReference(0.5, builder.build(kSeen, testing::polygonMoments(seen(0.0), 3)));
  const double alpha_star = builder.reference()->alpha_star;
  vpMomentObject goal = vispObject(seen(0.0));
  vpMomentCommon common(vpMomentCommon::getSurface(goal), vpMomentCommon::getMu3(goal), vpMomentCommon::getAlpha(goal),
                        0.5);
  vpMomentObject object = vispObject(seen(kPi));
  common.updateAll(object);
  bool found = false;
  const auto& alpha = dynamic_cast<const vpMomentAlpha&>(common.get("vpMomentAlpha", found));
  EXPECT_TRUE(alpha.is_symmetric());
  const MomentFeatures f = builder.build(kSeen, testing::polygonMoments(seen(kPi), 3));
  EXPECT_FALSE(f.symmetric);
  EXPECT_NEAR(std::remainder(f.alpha - alpha_star - kPi, 2.0 * kPi), 0.0, kRounding);
}

}  // namespace
}  // namespace aras_visual_servo_camera
