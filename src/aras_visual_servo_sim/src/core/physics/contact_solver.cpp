#include "contact_solver.hpp"

#include <algorithm>
#include <cmath>

namespace aras_visual_servo_sim {

namespace {

constexpr int kMaxRounds = 20;
constexpr int kMaxSweeps = 1000;
constexpr double kSettled = 1e-12;  // change of an impulse in a sweep, of the largest one
constexpr double kImmovable = 1e-300;

}  // namespace

const Eigen::VectorXd& ContactSolver::solve(const ContactRows& rows, const std::vector<double>& M_rows,
                                            const Eigen::VectorXd& v_free, const std::vector<JointGraph>& graphs,
                                            double dt_s, JointSolver& joints, Eigen::VectorXd& v,
                                            Eigen::VectorXd& effort) {
  const Eigen::Index n = v_free.size();
  const Eigen::MatrixXd M = Eigen::Map<const Eigen::MatrixXd>(M_rows.data(), n, n);  // symmetric
  const Eigen::LLT<Eigen::MatrixXd> factor(M);
  const Eigen::VectorXd v_before = v;
  lambda_ = Eigen::VectorXd::Zero(3 * rows.points());
  for (int round = 0; round < kMaxRounds; ++round) {
    Eigen::VectorXd push = rows.J.transpose() * lambda_;
    if (n > 0) factor.solveInPlace(push);  // Eigen takes the address of the first element
    v = v_before;
    joints.solve(M_rows, v_free + push, graphs, dt_s, v, effort);
    if (round > 0 && joints.pieces() == pieces_) break;
    pieces_ = joints.pieces();
    freeInverse(rows, M, graphs, dt_s, joints);
    Eigen::VectorXd u = rows.J * v + rows.u0 + rows.S * lambda_;
    sweep(rows, u, dt_s);
  }
  return lambda_;
}

/** D: how the velocities at the points answer to impulses there, the joints on the pieces they are on. */
void ContactSolver::freeInverse(const ContactRows& rows, const Eigen::MatrixXd& M,
                                const std::vector<JointGraph>& graphs, double dt_s, const JointSolver& joints) {
  const int n = static_cast<int>(M.rows());
  Eigen::MatrixXd A = M;
  Eigen::MatrixXd J = rows.J;
  for (int i = 0; i < n; ++i) {
    const JointSolver::Piece& piece = joints.pieces()[i];
    if (piece.vertical) {  // its velocity is given
      A.row(i).setZero();
      A.col(i).setZero();
      A(i, i) = 1.0;
      J.col(i).setZero();
    } else {
      A(i, i) += dt_s * graphs[i].line(piece.k).g;
    }
  }
  D_ = rows.S;
  if (n > 0) D_ += J * A.llt().solve(J.transpose());
}

/** Change of the normal impulse of a point; its compliance is that of spring and damper over the step. */
double ContactSolver::pushNormal(int row, double u, double depth_m, double dt_s) {
  const double rate = dt_s * stiffness_ + damping_;
  const double compliance = 1.0 / (dt_s * rate);
  const double wanted = stiffness_ * depth_m / rate;
  const double before = lambda_[row];
  lambda_[row] = std::max(0.0, before - (u + compliance * before - wanted) / (D_(row, row) + compliance));
  return lambda_[row] - before;
}

/** Change of the tangential impulse of a point: towards no slip, within the cone. */
Eigen::Vector2d ContactSolver::pushTangent(int row, const Eigen::Vector2d& u, double radius) {
  const double half_trace = 0.5 * (D_(row, row) + D_(row + 1, row + 1));
  const double half_gap = 0.5 * (D_(row, row) - D_(row + 1, row + 1));
  const double stiffest = half_trace + std::hypot(half_gap, D_(row, row + 1));
  const Eigen::Vector2d before = lambda_.segment<2>(row);
  Eigen::Vector2d after = before;
  if (stiffest > kImmovable) after -= u / stiffest;
  const double size = after.norm();
  if (size > radius) after *= radius / size;
  lambda_.segment<2>(row) = after;
  return after - before;
}

void ContactSolver::sweep(const ContactRows& rows, Eigen::VectorXd& u, double dt_s) {
  for (int count = 0; count < kMaxSweeps; ++count) {
    double change = 0.0;
    for (int point = 0; point < rows.points(); ++point) {
      const int row = 3 * point;
      const double normal = pushNormal(row, u[row], rows.depth_m[point], dt_s);
      if (normal != 0.0) u += normal * D_.col(row);
      const Eigen::Vector2d tangent = pushTangent(row + 1, u.segment<2>(row + 1), rows.friction[point] * lambda_[row]);
      u += D_.middleCols<2>(row + 1) * tangent;
      change = std::max({change, std::abs(normal), tangent.norm()});
    }
    if (change <= kSettled * lambda_.lpNorm<Eigen::Infinity>()) return;
  }
}

}  // namespace aras_visual_servo_sim
