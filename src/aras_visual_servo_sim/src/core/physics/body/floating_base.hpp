#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <vector>

#include "aras_visual_servo_sim/config/types.hpp"

namespace aras_visual_servo_sim {

/** The free root body of a robot: its state, and its six rows of the inertia matrix, which are eliminated.
 *
 *  The base takes no effort, so of M_bb (v_b - v_b_free) + M_bj (v_j - v_j_free) = 0 the joints see the inertia
 *  M_jj - M_bj^T M_bb^-1 M_bj, and the base follows once they are known. Velocities in world axes, [linear; angular],
 *  of the centre of mass. */
class FloatingBase {
 public:
  FloatingBase(double mass_kg, const Eigen::Vector3d& com_m, const Eigen::Matrix3d& inertia_kg_m2, int joints);

  /** @param X_WB  of the body frame, from which com_m is measured */
  void place(const Pose& X_WB);
  /** Pose and velocity exactly as pose() and velocity() gave them. */
  void restore(const Pose& X_WB, const Twist& v);
  Pose pose() const { return {p_, q_}; }
  const Eigen::Matrix3d& R() const { return R_; }
  const Eigen::Vector3d& p() const { return p_; }
  Eigen::Vector3d com() const { return p_ + R_ * com_m_; }
  double mass() const { return mass_kg_; }

  const Twist& velocity() const { return v_; }
  void setVelocity(const Twist& v) { v_ = v; }
  void setFreeVelocity(const Twist& v) { v_free_ = v; }
  /** Lets an impulse [linear; angular about the centre of mass] act in the step to come. */
  void addImpulse(const Twist& impulse) { v_free_ += factor_.solve(impulse); }
  /** M_bb^-1 f, column by column; after eliminate(). */
  Eigen::Matrix<double, 6, Eigen::Dynamic> answer(const Eigen::Matrix<double, 6, Eigen::Dynamic>& f) const {
    if (f.cols() == 0) return f;  // Eigen takes the address of the first element
    return factor_.solve(f);
  }
  /** What the base would do at the end of the step if the joints stood still then, having v_free freely. */
  Twist velocityWithJointsHeld(const Eigen::VectorXd& v_free) const { return v_free_ + response_ * v_free; }
  /** M_bb^-1 M_bj, (6, n). */
  const Eigen::Matrix<double, 6, Eigen::Dynamic>& response() const { return response_; }

  /** Momentum of what joint `index` carries when it alone moves at unit rate: P, and L about the world origin. */
  void setColumn(int index, const Eigen::Vector3d& P, const Eigen::Vector3d& L);

  /** Takes the base out of M, row-major (n, n), given the rest of the robot as mass, first and second moment about the
   *  world origin. After all columns were set. */
  void eliminate(double mass, const Eigen::Vector3d& first, const Eigen::Matrix3d& second, std::vector<double>& M);

  /** Velocity and pose at the end of a step in which the joints went from v_free to v. */
  void advance(const Eigen::VectorXd& v, const Eigen::VectorXd& v_free, double dt_s);

  /** What of the kinetic energy eliminate() took out of M. */
  double kineticEnergy(const Eigen::VectorXd& v) const;

 private:
  double mass_kg_;
  Eigen::Vector3d com_m_;
  Eigen::Matrix3d inertia_kg_m2_;
  Eigen::Vector3d p_ = Eigen::Vector3d::Zero();
  Eigen::Quaterniond q_ = Eigen::Quaterniond::Identity();
  Eigen::Matrix3d R_ = Eigen::Matrix3d::Identity();
  Twist v_ = Twist::Zero(), v_free_ = Twist::Zero();
  Eigen::Matrix<double, 6, 6> M_bb_ = Eigen::Matrix<double, 6, 6>::Identity();
  Eigen::LLT<Eigen::Matrix<double, 6, 6>> factor_;
  Eigen::Matrix<double, 6, Eigen::Dynamic> M_bj_, response_;  // response: M_bb^-1 M_bj
};

}  // namespace aras_visual_servo_sim
