#pragma once

namespace aras_visual_servo_sim {

/** Limits of one joint; a value counts only if its has_* is true. Units: m or rad, N or N m, m/s or rad/s. */
struct JointLimits {
  bool has_position = false, has_effort = false, has_velocity = false;
  double lower = 0.0, upper = 0.0, effort = 0.0, velocity = 0.0;
};

/** Interval an actuator's effort may lie in. */
struct EffortBounds {
  double min = 0.0, max = 0.0;
};

/** Position clamped to the limits. */
double clampPosition(const JointLimits& limits, double position);

/** Velocity clamped to the limits. */
double clampVelocity(const JointLimits& limits, double velocity);

/** Bounds of the effort at a state, as joint_limits_interface::EffortJointSaturationHandle has them: +-effort limit,
 * and none of it in the direction that leaves the position limits further or exceeds the velocity limit. */
EffortBounds effortBounds(const JointLimits& limits, double position, double velocity);

}  // namespace aras_visual_servo_sim
