#pragma once

#include <Eigen/Core>
#include <vector>

#include "joint_graph.hpp"

namespace aras_visual_servo_sim {

/** Finds the velocities at the end of a step: M (v - v_free) / dt = effort_i(v_i) on the graph of every joint.
 *
 *  M is positive definite and the graphs never increase, so this is the minimum of a strictly convex function: there is
 *  one solution. It is found exactly, by solving the linear system of the current piece of each graph and moving to the
 *  neighbouring piece where the solution leaves it; should that not settle, by Gauss-Seidel over the joints with an
 *  exact solution in each. Only arithmetic, no allocation: the same input gives the same bytes. */
class JointSolver {
 public:
  explicit JointSolver(int n);

  /** @param M       row-major (n, n)
   *  @param v_free  velocities the joints would have without any joint effort
   *  @param v       in: where to start the search, the velocities before the step; out: those after it
   *  @param effort  out: total effort of each graph */
  void solve(const std::vector<double>& M, const Eigen::VectorXd& v_free, const std::vector<JointGraph>& graphs,
             double dt_s, Eigen::VectorXd& v, Eigen::VectorXd& effort);

  /** Where a joint's velocity lies on its graph. */
  struct Piece {
    int k;  // segment, or point when vertical
    bool vertical;
    bool operator==(const Piece& other) const { return k == other.k && vertical == other.vertical; }
  };
  /** Of the last solution. */
  const std::vector<Piece>& pieces() const { return pieces_; }

  /** Linear systems solved so far, for tests and benchmarks. */
  long iterations() const { return iterations_; }
  /** Steps that needed Gauss-Seidel. */
  long fallbacks() const { return fallbacks_; }

 private:
  void solvePieces(const std::vector<double>& M, const Eigen::VectorXd& v_free, const std::vector<JointGraph>& graphs,
                   double dt_s, Eigen::VectorXd& v, Eigen::VectorXd& effort);
  void keepInPieces(const std::vector<JointGraph>& graphs, Eigen::VectorXd& v) const;
  bool movePieces(const std::vector<JointGraph>& graphs, const Eigen::VectorXd& v, const Eigen::VectorXd& effort);
  void sweep(const std::vector<double>& M, const Eigen::VectorXd& v_free, const std::vector<JointGraph>& graphs,
             double dt_s, Eigen::VectorXd& v);

  int n_;
  std::vector<Piece> pieces_;
  std::vector<double> A_, b_;
  std::vector<JointGraph::Line> lines_;
  long iterations_ = 0, fallbacks_ = 0;
};

}  // namespace aras_visual_servo_sim
