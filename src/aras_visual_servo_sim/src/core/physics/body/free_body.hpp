#pragma once

#include <Eigen/Core>

#include "aras_visual_servo_sim/physics/contact_config.hpp"

namespace aras_visual_servo_sim {

/** A rigid body with mass that hangs on nothing: it falls, is pushed and turns. Velocity in world axes, [linear;
 *  angular], of its frame's origin, which is its centre of mass. */
class FreeBody {
 public:
  /** Uniform; @pre obstacle.mass_kg > 0. @param size_m  edges of the bounding box, for meshes */
  FreeBody(const Obstacle& obstacle, const Eigen::Vector3d& size_m);

  const Pose& pose() const { return X_WB_; }
  const Twist& velocity() const { return v_; }
  void restore(const Pose& X_WB, const Twist& v);

  /** Velocity a step later without contact. */
  Twist freeVelocity(const Eigen::Vector3d& gravity_m_s2, double dt_s) const;
  /** M^-1 f of a wrench or impulse [force; torque] at the centre of mass. */
  Twist answer(const Twist& f) const;
  /** Takes the velocity at the end of a step, and moves. */
  void advance(const Twist& v, double dt_s);

 private:
  Eigen::Matrix3d inertia() const;

  double mass_kg_;
  Eigen::Vector3d moments_;  // in the body's axes
  Pose X_WB_;
  Twist v_ = Twist::Zero();
};

}  // namespace aras_visual_servo_sim
