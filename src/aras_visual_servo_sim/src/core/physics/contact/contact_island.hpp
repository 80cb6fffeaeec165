#pragma once

#include <Eigen/Core>
#include <Eigen/LU>
#include <vector>

namespace aras_visual_servo_sim {

constexpr double kImmovable = 1e-300;
// The friction at four corners of a face has more unknowns than a body has sideways motions, so the equations do not
// say how much each corner carries. This part of the stiffness is added to them; it keeps Newton's step near the
// previous solution, and leaves about this part of the slip.
constexpr double kStay = 1e-7;

/** Points of contact that answer to each other's impulses: one problem of its own.
 *
 *  Three rows for each point, the normal first: u = u_free + D lambda. Along the normal
 *  lambda = max(0, lambda - (u + compliance lambda - wanted) / D), across it lambda is what the cone leaves of
 *  lambda - u / D: Coulomb's friction. A fixed point of a sweep of projected Gauss-Seidel is a solution; Newton's
 *  method on the same equations (Alart and Curnier, Comput. Methods Appl. Mech. Eng. 92, 1991) gets near it in a few
 *  steps, and a sweep confirms it.
 *
 *  Many points touch few bodies: D = G G^T, with a column of G for each velocity of joints and bodies. Newton's step
 *  then solves for these velocities, not for the impulses. */
class ContactIsland {
 public:
  Eigen::MatrixXd D;
  Eigen::VectorXd u, lambda;                         ///< u: at these impulses
  std::vector<double> wanted, compliance, friction;  ///< of each point
  /** A bonded point has no cone: in each row u + compliance lambda = wanted, that of the normal included. */
  std::vector<char> bonded;
  std::vector<Eigen::Vector3d> bond_wanted;

  void resize(int points);
  int points() const { return static_cast<int>(wanted.size()); }

  /** Finds lambda, starting from what it is; u follows. The same input gives the same bytes.
   *  @param most_sweeps  after which it stops, with impulses within the cones that are the best so far
   *  @return whether they settled before that */
  bool solve(long most_sweeps = kMostSweeps);

  static constexpr long kMostSweeps = 200;

  /** Sweeps of all calls so far, for tests and benchmarks. */
  long sweeps() const { return sweeps_; }

 private:
  double sweep();
  double sweepMany();
  double pushNormal(int point, double speed);
  Eigen::Vector2d pushTangent(int point, const Eigen::Vector2d& slip);
  double stiffest(int row) const;
  Eigen::Vector3d bondError(int point) const;
  void newtonStep(bool all_hold);
  void linearizeTangent(int point, bool hold);
  void addAnswer(const Eigen::VectorXd& step);

  // With many points
  struct Branch;
  void factorize();
  void newtonStepMany(bool all_hold);
  Branch branchOf(int point, bool all_hold) const;

  bool many_ = false, factored_ = false;  ///< factored_: of many, D has so few columns that it is worth it
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  Rows G_;
  Eigen::VectorXd w_;  ///< velocities of joints and bodies that a sweep has added so far
  Eigen::MatrixXd A_;
  Eigen::VectorXd b_, step_, lambda_swept_, u_swept_;
  Eigen::PartialPivLU<Eigen::MatrixXd> factor_;
  long sweeps_ = 0;
};

}  // namespace aras_visual_servo_sim
