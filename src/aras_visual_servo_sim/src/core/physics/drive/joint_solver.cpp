#include "joint_solver.hpp"

#include <algorithm>
#include <cmath>

namespace aras_visual_servo_sim {

namespace {

// How far, relatively, a result of the linear system may lie outside its piece: its rounding, n^2 eps cond(M), with
// cond(M) up to 1e4 for an arm of six joints.
constexpr double kVelocityRounding = 1e-11;
constexpr double kEffortRounding = 1e-9;
constexpr int kMaxMoves = 40;
constexpr int kMaxSweeps = 20000;
constexpr double kSweepTolerance = 1e-14;

/** Solves A x = b in place for symmetric positive definite A (lower triangle used), x in b.
 *  @tparam kSize  n where it is known to the compiler, which then writes the loops out; else 0 */
template <int kSize>
void solveCholesky(int size, double* A, double* b) {
  const int n = kSize > 0 ? kSize : size;
  for (int j = 0; j < n; ++j) {
    double d = A[j * n + j];
    for (int k = 0; k < j; ++k) d -= A[j * n + k] * A[j * n + k];
    const double root = std::sqrt(d);
    const double inverse = 1.0 / root;
    A[j * n + j] = inverse;
    for (int i = j + 1; i < n; ++i) {
      double s = A[i * n + j];
      for (int k = 0; k < j; ++k) s -= A[i * n + k] * A[j * n + k];
      A[i * n + j] = s * inverse;
    }
    double s = b[j];
    for (int k = 0; k < j; ++k) s -= A[j * n + k] * b[k];
    b[j] = s * inverse;
  }
  for (int i = n - 1; i >= 0; --i) {
    double s = b[i];
    for (int k = i + 1; k < n; ++k) s -= A[k * n + i] * b[k];
    b[i] = s * A[i * n + i];
  }
}

void solveCholesky(int n, double* A, double* b) {
  if (n == 6) return solveCholesky<6>(n, A, b);  // most arms have six joints, or seven
  if (n == 7) return solveCholesky<7>(n, A, b);
  solveCholesky<0>(n, A, b);
}

}  // namespace

JointSolver::JointSolver(int n) : n_(n), pieces_(n), A_(n * n), b_(n), lines_(n) {}

void JointSolver::solve(const std::vector<double>& M, const Eigen::VectorXd& v_free,
                        const std::vector<JointGraph>& graphs, double dt_s, Eigen::VectorXd& v,
                        Eigen::VectorXd& effort) {
  for (int i = 0; i < n_; ++i) pieces_[i].k = graphs[i].locate(v[i], pieces_[i].vertical);
  for (int move = 0; move < kMaxMoves; ++move) {
    solvePieces(M, v_free, graphs, dt_s, v, effort);
    if (!movePieces(graphs, v, effort)) return keepInPieces(graphs, v);
  }
  ++fallbacks_;
  for (int i = 0; i < n_; ++i) v[i] = v_free[i];
  sweep(M, v_free, graphs, dt_s, v);
  solvePieces(M, v_free, graphs, dt_s, v, effort);
  keepInPieces(graphs, v);
}

/** Takes back what rounding carried over the end of a piece. */
void JointSolver::keepInPieces(const std::vector<JointGraph>& graphs, Eigen::VectorXd& v) const {
  for (int i = 0; i < n_; ++i) {
    if (pieces_[i].vertical) continue;
    const int k = pieces_[i].k;
    if (k > 0) v[i] = std::max(v[i], graphs[i].point(k - 1));
    if (k < graphs[i].points()) v[i] = std::min(v[i], graphs[i].point(k));
  }
}

/** The linear system of the current pieces, in the difference from v_free so that nothing is rounded where nothing
 * acts; joints on a vertical part have their velocity given. */
void JointSolver::solvePieces(const std::vector<double>& M, const Eigen::VectorXd& v_free,
                              const std::vector<JointGraph>& graphs, double dt_s, Eigen::VectorXd& v,
                              Eigen::VectorXd& effort) {
  ++iterations_;
  for (int i = 0; i < n_; ++i) {
    if (!pieces_[i].vertical) continue;
    v[i] = graphs[i].point(pieces_[i].k);
    b_[i] = v[i] - v_free[i];
    for (int j = 0; j < i; ++j) A_[i * n_ + j] = 0.0;
    A_[i * n_ + i] = 1.0;
  }
  for (int i = 0; i < n_; ++i) {
    if (pieces_[i].vertical) continue;
    const JointGraph::Line line = graphs[i].line(pieces_[i].k);
    double rhs = dt_s * (line.c - line.g * v_free[i]);
    for (int j = 0; j < n_; ++j) {
      const bool given = pieces_[j].vertical;
      if (given) rhs -= M[i * n_ + j] * (v[j] - v_free[j]);
      if (j < i) A_[i * n_ + j] = given ? 0.0 : M[i * n_ + j];
    }
    A_[i * n_ + i] = M[i * n_ + i] + dt_s * line.g;
    b_[i] = rhs;
    lines_[i] = line;
  }
  solveCholesky(n_, A_.data(), b_.data());
  for (int i = 0; i < n_; ++i) {
    if (pieces_[i].vertical) continue;
    v[i] = v_free[i] + b_[i];
    effort[i] = lines_[i].c - lines_[i].g * v[i];
  }
  for (int i = 0; i < n_; ++i) {
    if (!pieces_[i].vertical) continue;
    double sum = 0.0;
    for (int j = 0; j < n_; ++j) sum += M[i * n_ + j] * (v[j] - v_free[j]);
    effort[i] = sum / dt_s;
  }
}

/** @return whether any joint had to leave its piece. */
bool JointSolver::movePieces(const std::vector<JointGraph>& graphs, const Eigen::VectorXd& v,
                             const Eigen::VectorXd& effort) {
  bool moved = false;
  for (int i = 0; i < n_; ++i) {
    const JointGraph& graph = graphs[i];
    Piece& piece = pieces_[i];
    if (piece.vertical) {
      const double upper = graph.upper(piece.k);
      const double lower = graph.lower(piece.k);
      const double slack = kEffortRounding * std::abs(effort[i]);
      if (effort[i] > upper + slack) {
        piece = {piece.k, false};
      } else if (effort[i] < lower - slack) {
        piece = {piece.k + 1, false};
      } else {
        continue;
      }
      moved = true;
      continue;
    }
    const double slack = kVelocityRounding * std::abs(v[i]);
    while (!piece.vertical && piece.k > 0 && v[i] < graph.point(piece.k - 1) - slack) {
      --piece.k;
      piece.vertical = graph.upper(piece.k) > graph.lower(piece.k);
      moved = true;
    }
    while (!piece.vertical && piece.k < graph.points() && v[i] > graph.point(piece.k) + slack) {
      piece.vertical = graph.upper(piece.k) > graph.lower(piece.k);
      if (!piece.vertical) ++piece.k;
      moved = true;
    }
  }
  return moved;
}

/** Gauss-Seidel: each joint in turn goes where its own graph meets its own inertia, the others held. */
void JointSolver::sweep(const std::vector<double>& M, const Eigen::VectorXd& v_free,
                        const std::vector<JointGraph>& graphs, double dt_s, Eigen::VectorXd& v) {
  for (int count = 0; count < kMaxSweeps; ++count) {
    double change = 0.0;
    double largest = 0.0;
    for (int i = 0; i < n_; ++i) {
      double coupled = 0.0;
      for (int j = 0; j < n_; ++j) {
        if (j != i) coupled += M[i * n_ + j] * (v[j] - v_free[j]);
      }
      const double m = M[i * n_ + i] / dt_s;
      const double r = v_free[i] - coupled / M[i * n_ + i];
      const JointGraph& graph = graphs[i];
      int k = 0;
      while (k < graph.points() && m * (graph.point(k) - r) < graph.lower(k)) ++k;
      const bool vertical = k < graph.points() && m * (graph.point(k) - r) <= graph.upper(k);
      double v_new = vertical ? graph.point(k) : 0.0;
      if (!vertical) {
        const JointGraph::Line line = graph.line(k);
        v_new = (m * r + line.c) / (m + line.g);
      }
      pieces_[i] = {k, vertical};
      change = std::max(change, std::abs(v_new - v[i]));
      largest = std::max(largest, std::abs(v_new));
      v[i] = v_new;
    }
    if (change <= kSweepTolerance * largest) return;
  }
}

}  // namespace aras_visual_servo_sim
