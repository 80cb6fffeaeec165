#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <map>
#include <vector>

#include "contact_island.hpp"
#include "physics/drive/joint_graph.hpp"
#include "physics/drive/joint_solver.hpp"

namespace aras_visual_servo_sim {

/** Rows of the points of contact, three for each: along the normal and along two tangents.
 *
 *  The relative velocity at the points is u = J v + u0 + S lambda: J for the coordinates of the robot, u0 and S for
 *  what moves freely (a floating base, free bodies), lambda the impulses of the step [N s]. */
struct ContactRows {
  Eigen::MatrixXd J, S;
  Eigen::VectorXd u0;
  std::vector<double> depth_m, friction;
  std::map<int, Eigen::Vector3d> bonds;  ///< of the points that are bonded, by index: their gap along the rows [m]

  int points() const { return static_cast<int>(depth_m.size()); }
};

/** Contact impulses and the efforts of the joints, found together.
 *
 *  Normal force: max(0, k d - b v) with the depth d and the speed v at the end of the step; friction: Coulomb's cone,
 *  no slip inside it. The points are solved for on the pieces the joints' graphs are on, island by island, anew until
 *  the pieces stay. Nothing is remembered from one step to the next. The work of a step is bounded: beyond that the
 *  impulses are the best so far, within the cones. */
class ContactSolver {
 public:
  ContactSolver(double stiffness_n_per_m, double damping_n_s_per_m)
      : stiffness_(stiffness_n_per_m), damping_(damping_n_s_per_m) {}

  /** As JointSolver::solve, with contacts. @return the impulses, three for each point */
  const Eigen::VectorXd& solve(const ContactRows& rows, const std::vector<double>& M, const Eigen::VectorXd& v_free,
                               const std::vector<JointGraph>& graphs, double dt_s, JointSolver& joints,
                               Eigen::VectorXd& v, Eigen::VectorXd& effort);

  /** Whether the impulses of the last step settled within the bound. */
  bool settled() const { return settled_; }

 private:
  void freeInverse(const ContactRows& rows, const Eigen::MatrixXd& M, const std::vector<JointGraph>& graphs,
                   double dt_s, const JointSolver& joints);
  void findIslands(int points);
  void solveIsland(const ContactRows& rows, const Eigen::VectorXd& u, double dt_s, int island);

  double stiffness_, damping_;
  Eigen::MatrixXd D_;
  std::vector<int> island_of_;  // of each point, counted from 0
  int islands_ = 0;
  std::vector<int> members_;
  long work_left_ = 0;
  bool settled_ = true;
  ContactIsland island_;
  Eigen::VectorXd lambda_;
  std::vector<JointSolver::Piece> pieces_;
  std::vector<std::vector<JointSolver::Piece>> failed_;  // pieces whose impulses lead to others
};

}  // namespace aras_visual_servo_sim
