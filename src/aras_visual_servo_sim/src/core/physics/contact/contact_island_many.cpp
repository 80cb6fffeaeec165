// An island of many points: its equations in the velocities of joints and bodies, of which there are few.
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "contact_island.hpp"
#include "contact_island_limits.hpp"

namespace aras_visual_servo_sim {

using Eigen::Matrix2d;
using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

namespace {

constexpr double kNoVelocity = 1e-14;  // of the largest entry of D: rounding, no velocity of its own

}  // namespace

/** Rows of a point in Newton's equations: (B + C D) step = b. */
struct ContactIsland::Branch {
  Matrix3d B = Matrix3d::Identity(), C = Matrix3d::Zero();
  Vector3d b = Vector3d::Zero();
};

/** G of D = G G^T by Cholesky's method with pivots. It is given up when G has half as many columns as rows. */
void ContactIsland::factorize() {
  const Eigen::Index rows = D.rows(), most = rows / 2;
  Eigen::VectorXd left = D.diagonal();
  const double smallest = kNoVelocity * left.maxCoeff();
  G_.setZero(rows, most);
  Eigen::Index columns = 0;
  for (; columns < most; ++columns) {
    Eigen::Index pivot = 0;
    if (!(left.maxCoeff(&pivot) > smallest)) break;
    Eigen::VectorXd column = D.col(pivot);
    column.noalias() -= G_.leftCols(columns) * G_.row(pivot).head(columns).transpose();
    G_.col(columns) = column / std::sqrt(left[pivot]);
    left.array() -= G_.col(columns).array().square();
    left[pivot] = 0.0;
  }
  factored_ = columns < most;
  G_.conservativeResize(rows, columns);
}

double ContactIsland::sweepMany() {
  ++sweeps_;
  double change = 0.0;
  w_.setZero(G_.cols());
  for (int point = 0; point < points(); ++point) {
    const int row = 3 * point;
    const double normal = pushNormal(point, u[row] + G_.row(row).dot(w_));
    if (normal != 0.0) w_ += normal * G_.row(row).transpose();
    const Vector2d tangent = pushTangent(point, u.segment<2>(row + 1) + G_.middleRows<2>(row + 1) * w_);
    if (tangent != Vector2d::Zero()) w_.noalias() += G_.middleRows<2>(row + 1).transpose() * tangent;
    change = std::max({change, std::abs(normal), tangent.norm()});
  }
  u.noalias() += G_ * w_;
  return change;
}

/** As newtonStep: B s + C G w = b with w = G^T s, so (1 + G^T B^-1 C G) w = G^T B^-1 b. */
void ContactIsland::newtonStepMany(bool all_hold) {
  step_.setZero(3 * points());
  if (!factored_) return;  // sweeps alone
  const Eigen::Index columns = G_.cols();
  Rows CG(3 * points(), columns);
  b_.resize(3 * points());
  for (int point = 0; point < points(); ++point) {
    const int row = 3 * point;
    const Branch branch = branchOf(point, all_hold);
    const Matrix3d inverse = branch.B.inverse();
    CG.middleRows<3>(row).noalias() = Matrix3d(inverse * branch.C) * G_.middleRows<3>(row);
    b_.segment<3>(row) = inverse * branch.b;
  }
  A_.setIdentity(columns, columns);
  A_.noalias() += G_.transpose() * CG;
  w_ = A_.partialPivLu().solve(G_.transpose() * b_);
  step_ = b_ - CG * w_;
  if (!step_.allFinite()) step_.setZero();
  lambda += step_;
  addAnswer(step_);
}

ContactIsland::Branch ContactIsland::branchOf(int point, bool all_hold) const {
  const int row = 3 * point;
  Branch branch;
  if (!all_hold && !(lambda[row] > 0.0)) {  // apart: nothing acts
    branch.b = -lambda.segment<3>(row);
    return branch;
  }
  branch.B(0, 0) = compliance[point];
  branch.C(0, 0) = 1.0;
  branch.b[0] = wanted[point] - compliance[point] * lambda[row] - u[row];
  const double stiffness = stiffest(row + 1);
  if (!(stiffness > kImmovable)) return branch;  // nothing moves along the tangents
  const Vector2d slip = u.segment<2>(row + 1), drag = lambda.segment<2>(row + 1);
  const double radius = friction[point] * lambda[row];
  const Vector2d reach = drag - slip / stiffness;
  const double size = reach.norm();
  if (all_hold || size < radius) {
    branch.B.bottomRightCorner<2, 2>() *= kStay * stiffness;
    branch.C.bottomRightCorner<2, 2>().setIdentity();
    branch.b.tail<2>() = -slip;
    return branch;
  }
  // Slides: lambda = radius t, t the direction of reach.
  const Vector2d t = size > 0.0 ? Vector2d(reach / size) : Vector2d(Vector2d::Zero());
  const Matrix2d across =
      size > 0.0 ? Matrix2d(radius / size * (Matrix2d::Identity() - t * t.transpose())) : Matrix2d(Matrix2d::Zero());
  branch.B.bottomRightCorner<2, 2>() -= (1.0 - kStay) * across;
  branch.B.block<2, 1>(1, 0) = -friction[point] * t;
  branch.C.bottomRightCorner<2, 2>() = across / stiffness;
  branch.b.tail<2>() = radius * t - drag;
  return branch;
}

}  // namespace aras_visual_servo_sim
