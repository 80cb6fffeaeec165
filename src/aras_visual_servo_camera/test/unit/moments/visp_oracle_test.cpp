// ViSP's own polygon moments and features as a second opinion, where they are right.
#include <gtest/gtest.h>
#include <visp3/core/vpMomentAlpha.h>
#include <visp3/core/vpMomentCommon.h>
#include <visp3/core/vpMomentObject.h>
#include <visp3/core/vpPoint.h>
#include <visp3/visual_features/vpFeatureMomentCommon.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "aras_visual_servo_camera/moments/moment_features.hpp"
#include "aras_visual_servo_camera/moments/moments.hpp"
#include "coverage_image.hpp"

namespace aras_visual_servo_camera::visp_oracle_test {
namespace {

using testing::Polygon;

constexpr double kRounding = 1e-9;  // relative; ViSP sums powers of coordinates of order 1 without centring
constexpr FeatureBuilder::View kSeen{true, false, 1};

const Polygon kPolygon{{-0.15, -0.05}, {0.15, -0.1}, {0.1, 0.05}, {0.05, 0.125}, {-0.1, 0.1}};  // clockwise, y down
constexpr double kA = 0.3, kB = -0.4, kC = 1.7;                                                 // 1/Z = A x + B y + C
constexpr unsigned kC5 = 4, kC9 = 8, kC10 = 9, kCount = 10;

// ViSP wants polygons closed and clockwise on the screen (y down), which a positive area in these axes means.
vpMomentObject vispObject(Polygon polygon, unsigned order = 6) {
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
  vpMomentObject object(order);  // vpMomentCommon wants 5, and 5 is wrong in places
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

// What ViSP 3.5 has for the invariants c1 to c10 of a polygon: the numbers the controller's features of these names are
// held to (its test_features_invariants.py), and why their rows are not ViSP's.
struct Invariants {
  std::vector<double> values;
  std::vector<vpMatrix> rows;
};

Invariants invariantsOf(const Polygon& outline, unsigned order) {
  vpMomentObject object = vispObject(outline, order);
  vpMomentCommon common(vpMomentCommon::getSurface(object), vpMomentCommon::getMu3(object),
                        vpMomentCommon::getAlpha(object), 1.0);
  vpFeatureMomentCommon features(common);
  common.updateAll(object);
  features.updateAll(kA, kB, kC);
  bool found = false;
  Invariants result{common.get("vpMomentCInvariant", found).get(), {}};
  for (unsigned k = 0; k < kCount; ++k) result.rows.push_back(features.getFeatureCInvariant().interaction(1U << k));
  return result;
}

// The outline after the camera moved along one axis for a time h, its corners by the rows of points: exact to first
// order in h, as edges stay straight.
Polygon moved(Polygon outline, unsigned axis, double h) {
  for (auto& corner : outline) {
    const double x = corner.x, y = corner.y, over_Z = kA * x + kB * y + kC;
    const std::array<double, 6> Lx{-over_Z, 0.0, x * over_Z, x * y, -1.0 - x * x, y};
    const std::array<double, 6> Ly{0.0, -over_Z, y * over_Z, 1.0 + y * y, -x * y, -x};
    corner = {x + h * Lx[axis], y + h * Ly[axis]};
  }
  return outline;
}

// Largest difference of ViSP's row k from the central differences of ViSP's value, of the largest entry of these.
double errorOfRow(unsigned k, unsigned order) {
  constexpr double kStep = 1e-6;  // rounding some 1e-9, truncation less
  const Invariants here = invariantsOf(kPolygon, order);
  double error = 0.0, largest = 0.0;
  for (unsigned axis = 0; axis < 6; ++axis) {
    const double ahead = invariantsOf(moved(kPolygon, axis, kStep), order).values[k];
    const double behind = invariantsOf(moved(kPolygon, axis, -kStep), order).values[k];
    const double wanted = (ahead - behind) / (2.0 * kStep);
    error = std::max(error, std::abs(here.rows[k][0][axis] - wanted));
    largest = std::max(largest, std::abs(wanted));
  }
  return error / largest;
}

TEST(VispInvariants, OfANamedPolygonAreWhatTheControllerIsHeldTo) {
  const std::array<double, kCount> wanted{-2.306633013296,  21.17623238498,  0.5551113372762, 0.1268341769118,
                                          -0.4245021432336, 0.2561844374762, -3.248871231112, 17.09313437557,
                                          0.3607953510602,  2.381893402321};
  const std::vector<double> found = invariantsOf(kPolygon, 6).values;
  for (unsigned k = 0; k < kCount; ++k) EXPECT_NEAR(found[k], wanted[k], 1e-9 * std::abs(wanted[k])) << "c" << k + 1;
}

TEST(VispInvariants, RowsAreDerivativesButForC5AndBelowOrder6C9AndC10) {
  // The reason for rows of our own.
  for (unsigned k = 0; k < kCount; ++k) {
    if (k != kC5) {
      EXPECT_LT(errorOfRow(k, 6), 1e-7) << "c" << k + 1;
    }
  }
  EXPECT_GT(errorOfRow(kC5, 6), 1.0);
  for (const unsigned k : {kC9, kC10}) EXPECT_GT(errorOfRow(k, 5), 0.1) << "c" << k + 1;
}

}  // namespace
}  // namespace aras_visual_servo_camera::visp_oracle_test
