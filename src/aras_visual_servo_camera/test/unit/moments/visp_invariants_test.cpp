// What ViSP 3.5 has for the invariants c1 to c10 of a polygon: the numbers the controller's features of these names are
// held to (its test_features_invariants.py), and why their rows are not ViSP's.
#include <gtest/gtest.h>
#include <visp3/core/vpMomentCommon.h>
#include <visp3/core/vpMomentObject.h>
#include <visp3/core/vpPoint.h>
#include <visp3/visual_features/vpFeatureMomentCommon.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace {

using Outline = std::vector<std::array<double, 2>>;

const Outline kPolygon{{-0.15, -0.05}, {0.15, -0.1}, {0.1, 0.05}, {0.05, 0.125}, {-0.1, 0.1}};  // clockwise, y down
constexpr double kA = 0.3, kB = -0.4, kC = 1.7;                                                 // 1/Z = A x + B y + C
constexpr unsigned kC5 = 4, kC9 = 8, kC10 = 9, kCount = 10;

vpMomentObject objectOf(const Outline& outline, unsigned order) {
  std::vector<vpPoint> points;
  for (std::size_t k = 0; k <= outline.size(); ++k) {
    vpPoint p;
    p.set_x(outline[k % outline.size()][0]);
    p.set_y(outline[k % outline.size()][1]);
    points.push_back(p);
  }
  vpMomentObject object(order);
  object.setType(vpMomentObject::DENSE_POLYGON);
  object.fromVector(points);
  return object;
}

struct Invariants {
  std::vector<double> values;
  std::vector<vpMatrix> rows;
};

Invariants invariantsOf(const Outline& outline, unsigned order) {
  vpMomentObject object = objectOf(outline, order);
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
Outline moved(Outline outline, unsigned axis, double h) {
  for (auto& corner : outline) {
    const double x = corner[0], y = corner[1], over_Z = kA * x + kB * y + kC;
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
