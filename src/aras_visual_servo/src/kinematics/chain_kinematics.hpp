#pragma once

#include <Eigen/Core>
#include <aras_visual_servo_common/errors.hpp>
#include <kdl/chain.hpp>
#include <string>
#include <utility>
#include <vector>

#include "twist_inverse.hpp"

namespace aras_visual_servo {

using aras_visual_servo_common::ModelError;
using aras_visual_servo_common::NotFiniteError;
using aras_visual_servo_common::ShapeError;

/** Kinematics of the chain base -> tip of a URDF. Constant after construction.
 *
 *  Joint vectors hold the moving joints of the chain SORTED BY NAME, in m or rad. B is the frame of the base link, C
 *  that of the tip link (the camera optical frame). Twists are stacked [v; w]. */
class ChainKinematics {
 public:
  using Matrix4 = Eigen::Matrix<double, 4, 4, Eigen::RowMajor>;
  using Jacobian = Eigen::Matrix<double, 6, Eigen::Dynamic, Eigen::RowMajor>;
  using Joints = Eigen::Ref<const Eigen::VectorXd>;

  /** @param upwards  the chain may lead up against joints first and then down, as from a gripper to a camera that
   *                  stands beside the robot; else the tip has to be below the base
   *  @throws ModelError  bad XML, unknown link, tip not below base, no moving joint between them, or a joint that is
   *                      neither revolute, continuous, prismatic nor fixed, or mimics another one */
  ChainKinematics(const std::string& urdf_xml, const std::string& base_link, const std::string& tip_link,
                  bool upwards = false);

  const std::vector<std::string>& jointNames() const { return joint_names_; }
  /** Limits [m or rad; m/s or rad/s]; infinite where the URDF has none (continuous joints). */
  const Eigen::VectorXd& lower() const { return lower_; }
  const Eigen::VectorXd& upper() const { return upper_; }
  const Eigen::VectorXd& velocity() const { return velocity_; }

  /** X_BC, 4 x 4 homogeneous. @throws ShapeError, NotFiniteError */
  Matrix4 pose(const Joints& q) const;

  /** J_BC_C, 6 x n: V_BC_C = J_BC_C q_dot, the twist of C in B, taken at the origin of C and expressed in C.
   *  @throws ShapeError, NotFiniteError */
  Jacobian jacobian(const Joints& q) const;

  /** Joint velocities that keep every joint's velocity limit and whose twist is right half-way while they are held.
   *  All are slowed by one factor, and then corrected for the change of the Jacobian.
   *  @param inverse, jacobian  those of q.  @param dt_s  for how long they are held [s]
   *  @param most_part  the correction is at most this part of them
   *  @return the velocities, n, and the factor, in (0, 1].  @throws ShapeError, NotFiniteError */
  std::pair<Eigen::VectorXd, double> held(const TwistInverse& inverse, const TwistInverse::JacobianRef& jacobian,
                                          const Joints& q, const Joints& q_dot, double dt_s, double most_part) const;

  /** Yoshikawa's manipulability w = sqrt(det(A A^T)), A = rows of J_BC_C with the linear ones divided by a length, and
   * the gradient of its logarithm by the joints (docs/theory.md T42).
   *  @param length_m  characteristic length [m]
   *  @param rows  which of [vx vy vz wx wy wz], at most as many as there are joints
   *  @return w [-] and d(ln w)/dq, n [1/m or 1/rad]; where w vanishes, 0 and zeros
   *  @throws ShapeError, NotFiniteError */
  std::pair<double, Eigen::VectorXd> manipulability(const Joints& q, double length_m,
                                                    const std::vector<int>& rows) const;

 private:
  void check(const Joints& q) const;

  KDL::Chain chain_;
  std::vector<std::string> joint_names_;
  std::vector<int> index_;  ///< chain position of a moving joint -> index in joint_names_
  Eigen::VectorXd lower_, upper_, velocity_;
};

}  // namespace aras_visual_servo
