#pragma once

#include <Eigen/Core>
#include <optional>
#include <utility>

namespace aras_visual_servo {

using JointsRef = Eigen::Ref<const Eigen::VectorXd>;

/** Requires that a vector has so many values. @throws ShapeError */
void requireSize(const char* name, Eigen::Index found, Eigen::Index expected);

/** Joint velocities wanted where the twist leaves a choice: back to a posture, and away from joint limits. */
class Wish {
 public:
  /** @param lower, upper  limits of n joints, may be infinite
   *  @param posture_gain_per_s  rate of return to the posture, >= 0
   *  @param joint_limit_gain_per_s  rate at a limit, falling with the cube of the distance from the middle, >= 0
   *  @param max_speed  of any joint, > 0 [m/s, rad/s] */
  Wish(const Eigen::VectorXd& lower, const Eigen::VectorXd& upper, double posture_gain_per_s,
       double joint_limit_gain_per_s, double max_speed);

  /** Wanted velocities at q, n each.  @param more  added to them.  @throws ShapeError */
  Eigen::VectorXd operator()(const JointsRef& q, const std::optional<Eigen::VectorXd>& posture,
                             const std::optional<Eigen::VectorXd>& more) const;

 private:
  Eigen::VectorXd middle_, limit_gain_;
  double posture_gain_, max_speed_;
};

/** Factor in (0, 1] that brings every joint within its velocity limit and keeps the direction of motion.
 *  @param limit  n, > 0 or infinite [m/s or rad/s].  @throws ShapeError */
double velocityFactor(const JointsRef& q_dot, const JointsRef& limit);

/** Factor in [0, 1] that keeps q + q_dot * horizon_s within [lower, upper], and the joint that needs that factor, if
 *  any. A joint beyond its limit may only move back.
 *  @param lower, upper  n, may be infinite.  @param horizon_s  > 0 [s].  @throws ShapeError */
std::pair<double, std::optional<int>> positionFactor(const JointsRef& q, const JointsRef& q_dot, const JointsRef& lower,
                                                     const JointsRef& upper, double horizon_s);

}  // namespace aras_visual_servo
