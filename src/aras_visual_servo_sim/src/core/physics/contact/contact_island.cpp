#include "contact_island.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

namespace aras_visual_servo_sim {

using Eigen::Matrix2d;
using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

namespace {

constexpr int kMostDense = 24;      // points; with more Newton's step is solved for in velocities
constexpr int kMaxShortenings = 4;  // of a step of Newton's that leads away
constexpr double kShorter = 0.3;
constexpr int kSweepsAfterRetreat = 3;
constexpr double kNoVelocity = 1e-14;  // of the largest entry of D: rounding, no velocity of its own
constexpr double kSettled = 1e-10;     // change of an impulse in a sweep, of the largest one

}  // namespace

void ContactIsland::resize(int points) {
  const Eigen::Index rows = 3 * points;
  D.resize(rows, rows);
  u.resize(rows);
  lambda.resize(rows);
  wanted.resize(points);
  compliance.resize(points);
  friction.resize(points);
  bonded.assign(points, 0);
  bond_wanted.assign(points, Vector3d::Zero());
}

bool ContactIsland::solve(long most_sweeps) {
  many_ = points() > kMostDense;
  if (many_) factorize();
  if (lambda.isZero(0.0)) newtonStep(true);  // finds bodies at rest at once, with the smallest impulses
  double change_before = std::numeric_limits<double>::infinity();
  int shortenings = 0;
  int sweeps_alone = 0;
  bool swept = false;  // whether there are impulses of a sweep to come back to
  for (long count = 0; count < most_sweeps; ++count) {
    const double change = many_ && factored_ ? sweepMany() : sweep();
    if (change <= kSettled * lambda.lpNorm<Eigen::Infinity>()) return true;
    if (sweeps_alone > 0) {
      --sweeps_alone;
    } else if (change <= change_before) {
      change_before = change;
      shortenings = 0;
      lambda_swept_ = lambda;
      u_swept_ = u;
      swept = true;
      newtonStep(false);
    } else if (shortenings < kMaxShortenings) {
      ++shortenings;
      step_ *= kShorter;
      lambda = lambda_swept_ + step_;
      u = u_swept_;
      addAnswer(step_);
    } else {  // sweeps go on from before the step
      lambda = lambda_swept_;
      u = u_swept_;
      change_before = std::numeric_limits<double>::infinity();
      sweeps_alone = kSweepsAfterRetreat;
    }
  }
  if (sweeps_alone > 0 || !swept) return false;
  lambda = lambda_swept_;  // no sweeps left: the last ones are within the cones
  u = u_swept_;
  return false;
}

void ContactIsland::addAnswer(const Eigen::VectorXd& step) {
  if (many_ && factored_) {
    w_.noalias() = G_.transpose() * step;
    u.noalias() += G_ * w_;
  } else {
    u.noalias() += D * step;
  }
}

/** @return the largest change of an impulse */
double ContactIsland::sweep() {
  ++sweeps_;
  double change = 0.0;
  for (int point = 0; point < points(); ++point) {
    const double normal = pushNormal(point, u[3 * point]);
    if (normal != 0.0) u += normal * D.col(3 * point);
    const Vector2d tangent = pushTangent(point, u.segment<2>(3 * point + 1));
    if (tangent != Vector2d::Zero()) u += D.middleCols<2>(3 * point + 1) * tangent;
    change = std::max({change, std::abs(normal), tangent.norm()});
  }
  return change;
}

/** Change of the normal impulse of a point. */
double ContactIsland::pushNormal(int point, double speed) {
  const int row = 3 * point;
  const double before = lambda[row];
  const double pull = (speed + compliance[point] * before - wanted[point]) / (D(row, row) + compliance[point]);
  if (bonded[point]) {
    lambda[row] = before - pull;
    return -pull;
  }
  lambda[row] = std::max(0.0, before - pull);
  return lambda[row] - before;
}

/** Change of the tangential impulse of a point: towards no slip, within the cone. */
Vector2d ContactIsland::pushTangent(int point, const Vector2d& slip) {
  const int row = 3 * point + 1;
  if (bonded[point]) {
    const Vector2d error = slip + compliance[point] * lambda.segment<2>(row) - bond_wanted[point].tail<2>();
    const Vector2d change = -error / (stiffest(row) + compliance[point]);
    lambda.segment<2>(row) += change;
    return change;
  }
  const double radius = friction[point] * lambda[row - 1];
  const Vector2d before = lambda.segment<2>(row);
  Vector2d after = before;
  if (stiffest(row) > kImmovable) after -= slip / stiffest(row);
  const double size = after.norm();
  if (size > radius) after *= radius / size;
  lambda.segment<2>(row) = after;
  return after - before;
}

/** Larger eigenvalue of the 2 x 2 block of D at a row. */
double ContactIsland::stiffest(int row) const {
  const double half_trace = 0.5 * (D(row, row) + D(row + 1, row + 1));
  const double half_gap = 0.5 * (D(row, row) - D(row + 1, row + 1));
  return half_trace + std::hypot(half_gap, D(row, row + 1));
}

/** What is missing in the equations of a bonded point. */
Vector3d ContactIsland::bondError(int point) const {
  const int row = 3 * point;
  return bond_wanted[point] - u.segment<3>(row) - compliance[point] * lambda.segment<3>(row);
}

/** Solves the equations of the branches the sweep left the points on, or as if all points touched and held. */
void ContactIsland::newtonStep(bool all_hold) {
  if (many_) return newtonStepMany(all_hold);
  A_ = D;
  b_ = -u;
  for (int point = 0; point < points(); ++point) {
    const int row = 3 * point;
    if (bonded[point]) {
      A_.block<3, 3>(row, row) += compliance[point] * Matrix3d::Identity();
      b_.segment<3>(row) = bondError(point);
    } else if (all_hold || lambda[row] > 0.0) {
      A_(row, row) += compliance[point];
      b_[row] += wanted[point] - compliance[point] * lambda[row];
      linearizeTangent(point, all_hold);
    } else {  // apart: nothing acts
      A_.middleRows<3>(row).setZero();
      A_.block<3, 3>(row, row).setIdentity();
      b_.segment<3>(row) = -lambda.segment<3>(row);
    }
  }
  factor_.compute(A_);
  step_ = factor_.solve(b_);
  if (!step_.allFinite()) step_.setZero();
  lambda += step_;
  u.noalias() += D * step_;
}

void ContactIsland::linearizeTangent(int point, bool hold) {
  const int row = 3 * point + 1;
  const double stiffness = stiffest(row);
  if (!(stiffness > kImmovable)) {  // nothing moves along the tangents
    A_.middleRows<2>(row).setZero();
    A_.block<2, 2>(row, row).setIdentity();
    b_.segment<2>(row).setZero();
    return;
  }
  const double radius = friction[point] * lambda[row - 1];
  const Vector2d reach = lambda.segment<2>(row) - u.segment<2>(row) / stiffness;
  const double size = reach.norm();
  if (hold || size < radius) {
    A_.block<2, 2>(row, row) += kStay * stiffness * Matrix2d::Identity();
    return;
  }
  // Slides: lambda = radius t, t the direction of reach.
  const Vector2d t = size > 0.0 ? Vector2d(reach / size) : Vector2d(Vector2d::Zero());
  const Matrix2d across =
      size > 0.0 ? Matrix2d(radius / size * (Matrix2d::Identity() - t * t.transpose())) : Matrix2d(Matrix2d::Zero());
  A_.middleRows<2>(row) = across / stiffness * D.middleRows<2>(row);
  A_.block<2, 2>(row, row) += Matrix2d::Identity() - (1.0 - kStay) * across;
  A_.block<2, 1>(row, row - 1) -= friction[point] * t;
  b_.segment<2>(row) = radius * t - lambda.segment<2>(row);
}

// --- many points: the equations in the velocities of joints and bodies, of which there are few
// ------------------------

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
  if (bonded[point]) {
    branch.B *= compliance[point];
    branch.C.setIdentity();
    branch.b = bondError(point);
    return branch;
  }
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
