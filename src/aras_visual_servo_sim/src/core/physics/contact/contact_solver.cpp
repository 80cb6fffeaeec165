#include "contact_solver.hpp"

#include <algorithm>

namespace aras_visual_servo_sim {

namespace {

constexpr int kMaxRounds = 40;
// Of a step: a round costs the square of the points, a sweep with its step of Newton's kSweepWork for each of them.
constexpr long kMostWork = 400000;
constexpr long kSweepWork = 20;
constexpr long kFewestSweeps = 8;
// Of a bond: the part of its gap that a step closes, and how far it gives way, of how its bodies do.
constexpr double kClosed = 0.2;
constexpr double kBondCompliance = 1e-6;

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
  const auto moveJoints = [&] {
    Eigen::VectorXd push = rows.J.transpose() * lambda_;
    if (n > 0) factor.solveInPlace(push);  // Eigen takes the address of the first element
    v = v_before;
    joints.solve(M_rows, v_free + push, graphs, dt_s, v, effort);
  };
  failed_.clear();
  bool solved = false;  // whether the impulses are those of the pieces the joints were on last
  int averages = 0;
  work_left_ = kMostWork;
  for (int round = 0; round < kMaxRounds; ++round) {
    moveJoints();
    if (solved && joints.pieces() == pieces_) return lambda_;
    if (work_left_ < 0) break;
    work_left_ -= static_cast<long>(rows.points()) * rows.points();
    settled_ = true;
    if (solved) failed_.push_back(pieces_);
    pieces_ = joints.pieces();
    freeInverse(rows, M, graphs, dt_s, joints);
    findIslands(rows.points());
    const Eigen::VectorXd u = rows.J * v + rows.u0 + rows.S * lambda_;
    const Eigen::VectorXd lambda_before = lambda_;
    for (int island = 0; island < islands_; ++island) solveIsland(rows, u, dt_s, island);
    // A joint at its speed limit pushes with whatever effort it takes, so contacts may push it as far as its stop. The
    // pieces of its graph between the two are then visited one after the other.
    solved = std::find(failed_.begin(), failed_.end(), pieces_) == failed_.end();
    if (!solved) lambda_ = lambda_before + (lambda_ - lambda_before) / (++averages + 1.0);
  }
  settled_ = false;
  moveJoints();  // did not settle: use the velocities that follow from the impulses
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

/** Points whose impulses answer to each other, directly or through others. */
void ContactSolver::findIslands(int points) {
  island_of_.assign(points, -1);
  islands_ = 0;
  for (int first = 0; first < points; ++first) {
    if (island_of_[first] >= 0) continue;
    island_of_[first] = islands_;
    members_.assign(1, first);
    while (!members_.empty()) {
      const int point = members_.back();
      members_.pop_back();
      for (int other = first + 1; other < points; ++other) {
        if (island_of_[other] >= 0 || D_.block<3, 3>(3 * point, 3 * other).isZero(0.0)) continue;
        island_of_[other] = islands_;
        members_.push_back(other);
      }
    }
    ++islands_;
  }
}

void ContactSolver::solveIsland(const ContactRows& rows, const Eigen::VectorXd& u, double dt_s, int island) {
  members_.clear();
  for (int point = 0; point < rows.points(); ++point) {
    if (island_of_[point] == island) members_.push_back(point);
  }
  const int count = static_cast<int>(members_.size());
  // Spring and damper over the step: k (d - dt u) - b u.
  const double rate = dt_s * stiffness_ + damping_;
  island_.resize(count);
  for (int i = 0; i < count; ++i) {
    const int from = 3 * members_[i];
    for (int j = 0; j < count; ++j) island_.D.block<3, 3>(3 * i, 3 * j) = D_.block<3, 3>(from, 3 * members_[j]);
    island_.u.segment<3>(3 * i) = u.segment<3>(from);
    island_.lambda.segment<3>(3 * i) = lambda_.segment<3>(from);
    island_.wanted[i] = stiffness_ * rows.depth_m[members_[i]] / rate;
    island_.compliance[i] = 1.0 / (dt_s * rate);
    island_.friction[i] = rows.friction[members_[i]];
    if (const auto bond = rows.bonds.find(members_[i]); bond != rows.bonds.end()) {
      island_.bonded[i] = 1;
      island_.bond_wanted[i] = kClosed / dt_s * bond->second;
      island_.wanted[i] = island_.bond_wanted[i][0];
      island_.compliance[i] = kBondCompliance * D_.block<3, 3>(from, from).trace() + kImmovable;
    }
  }
  const long before = island_.sweeps(), affordable = work_left_ / (kSweepWork * count);
  if (!island_.solve(std::clamp(affordable, kFewestSweeps, ContactIsland::kMostSweeps))) settled_ = false;
  work_left_ -= kSweepWork * count * (island_.sweeps() - before);
  for (int i = 0; i < count; ++i) lambda_.segment<3>(3 * members_[i]) = island_.lambda.segment<3>(3 * i);
}

}  // namespace aras_visual_servo_sim
