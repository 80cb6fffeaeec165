#include "quadratic_program.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Jacobi>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "aras_visual_servo_common/errors.hpp"

namespace aras_visual_servo {

namespace common = aras_visual_servo_common;

namespace {

using Matrix = Eigen::MatrixXd;
using Vector = Eigen::VectorXd;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
/** A row of length 1 is kept when it is violated by less than this: rounding of a sum of a hundred products near 1. */
constexpr double kKept = 1e-11;
/** Part of a row that has to be outside the rows taken up already, or it depends on them. */
constexpr double kIndependent = 1e-9;

void check(const Matrix& H, const Vector& g, const Matrix& A, const Vector& b) {
  const auto n = g.size();
  if (n < 1 || H.rows() != n || H.cols() != n || A.cols() != n || A.rows() != b.size())
    throw common::ShapeError("quadratic program: found H " + std::to_string(H.rows()) + " x " +
                             std::to_string(H.cols()) + ", g " + std::to_string(n) + ", A " + std::to_string(A.rows()) +
                             " x " + std::to_string(A.cols()) + ", b " + std::to_string(b.size()) +
                             ", allowed n x n, n >= 1, m x n, m");
  if (!H.allFinite() || !g.allFinite() || !A.allFinite() || b.hasNaN() || (b.array() == kInfinity).any())
    throw common::NotFiniteError("quadratic program: allowed finite numbers, and -inf in b");
}

/** The rows taken up, as the factors Q and R of the whole: J' H J = 1, and J' N = (R; 0) for their normals N. */
class ActiveSet {
 public:
  explicit ActiveSet(const Eigen::LLT<Matrix>& cholesky)
      : J_(Matrix::Identity(cholesky.rows(), cholesky.rows())), R_(Matrix::Zero(J_.rows(), J_.rows())) {
    cholesky.matrixU().solveInPlace(J_);
  }

  const std::vector<int>& rows() const { return rows_; }
  const Vector& multipliers() const { return u_; }

  /** Sets the directions for a row with this normal: of x, and of the multipliers, which fall by `r` each. */
  void aim(const Vector& normal) {
    const int q = size();
    d_.noalias() = J_.transpose() * normal;
    z_.noalias() = J_.rightCols(J_.cols() - q) * d_.tail(J_.cols() - q);
    r_ = d_.head(q);
    R_.topLeftCorner(q, q).triangularView<Eigen::Upper>().solveInPlace(r_);
  }

  const Vector& z() const { return z_; }

  /** Whether the row depends on those taken up. Its length in the metric of H is that of d. */
  bool dependent() const { return d_.tail(J_.cols() - size()).norm() <= kIndependent * d_.norm(); }

  /** The longest step before a multiplier becomes negative, and which; kInfinity if none does. */
  std::pair<double, int> blocking() const {
    double step = kInfinity;
    int which = -1;
    for (int i = 0; i < size(); ++i) {
      if (r_[i] <= 0.0 || u_[i] >= step * r_[i]) continue;
      step = u_[i] / r_[i];
      which = i;
    }
    return {step, which};
  }

  void step(double t) {
    if (size() > 0) u_ -= t * r_;
  }

  /** Takes up the row that `aim` was called with. */
  void add(int row, double multiplier) {
    const int q = size();
    for (Eigen::Index i = J_.cols() - 1; i > q; --i) {
      Eigen::JacobiRotation<double> turn;
      turn.makeGivens(d_[i - 1], d_[i], &d_[i - 1]);
      d_[i] = 0.0;
      J_.applyOnTheRight(i - 1, i, turn);
    }
    R_.col(q).head(q + 1) = d_.head(q + 1);
    rows_.push_back(row);
    u_.conservativeResize(q + 1);
    u_[q] = multiplier;
  }

  /** Gives back the row at this place. */
  void drop(int place) {
    const int q = size();
    for (int j = place; j + 1 < q; ++j) {
      R_.col(j).head(j + 2) = R_.col(j + 1).head(j + 2);
      u_[j] = u_[j + 1];
    }
    R_.col(q - 1).setZero();
    for (int j = place; j + 1 < q; ++j) {
      Eigen::JacobiRotation<double> turn;
      double length = 0.0;
      turn.makeGivens(R_(j, j), R_(j + 1, j), &length);
      R_.middleCols(j, q - 1 - j).applyOnTheLeft(j, j + 1, turn.adjoint());
      R_(j + 1, j) = 0.0;
      J_.applyOnTheRight(j, j + 1, turn);
    }
    rows_.erase(rows_.begin() + place);
    u_.conservativeResize(q - 1);
  }

 private:
  int size() const { return static_cast<int>(rows_.size()); }

  Matrix J_, R_;
  Vector u_ = Vector(0), d_, z_, r_;
  std::vector<int> rows_;
};

/** The row that is violated most, in units of its length; -1 when all are kept. */
int mostViolated(const Vector& left, const Vector& lengths, const Vector& b) {
  int worst = -1;
  double most = kKept;
  for (int i = 0; i < left.size(); ++i) {
    const double scale = std::max(lengths[i], kKept);
    const double violation = -left[i] / (scale * (1.0 + std::abs(b[i]) / scale));
    if (!(violation > most)) continue;
    most = violation;
    worst = i;
  }
  return worst;
}

}  // namespace

QuadraticAnswer solveProgram(const Matrix& H, const Vector& g, const Matrix& A, const Vector& b) {
  check(H, g, A, b);
  const Eigen::LLT<Matrix> cholesky(H);
  if (cholesky.info() != Eigen::Success)
    throw common::NotFiniteError("quadratic program: found H that is not positive definite");
  QuadraticAnswer answer;
  answer.x = -cholesky.solve(g);
  answer.multipliers = Vector::Zero(b.size());
  ActiveSet active(cholesky);
  const Vector lengths = A.rowwise().norm();
  const int most = 20 * static_cast<int>(g.size() + b.size());
  while (answer.iterations < most) {
    Vector left = A * answer.x - b;
    for (const int row : active.rows()) left[row] = 0.0;
    const int row = mostViolated(left, lengths, b);
    if (row < 0) {
      answer.feasible = true;
      break;
    }
    const Vector normal = A.row(row);
    double multiplier = 0.0;
    bool taken = false;
    while (!taken && answer.iterations++ < most) {
      active.aim(normal);
      const auto [block, place] = active.blocking();
      const bool dependent = active.dependent();
      const double full = dependent ? kInfinity : (b[row] - normal.dot(answer.x)) / active.z().dot(normal);
      const double step = std::min(block, full);
      if (step == kInfinity) return answer;  // infeasible
      if (!dependent) answer.x += step * active.z();
      active.step(step);
      multiplier += step;
      taken = full <= block;
      if (taken)
        active.add(row, multiplier);
      else
        active.drop(place);
    }
  }
  for (std::size_t i = 0; i < active.rows().size(); ++i) answer.multipliers[active.rows()[i]] = active.multipliers()[i];
  return answer;
}

}  // namespace aras_visual_servo
