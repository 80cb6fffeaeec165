#pragma once

namespace aras_visual_servo_sim {

/** Limits of one joint; a value counts only if its has_* is true. Units: m or rad, N or N m, m/s or rad/s. */
struct JointLimits {
  bool has_position = false, has_effort = false, has_velocity = false, has_acceleration = false;
  double lower = 0.0, upper = 0.0, effort = 0.0, velocity = 0.0, acceleration = 0.0;
};

/** <safety_controller>: velocities allowed near soft position limits, efforts allowed near those velocities. */
struct SoftLimits {
  bool present = false;
  double k_position = 0.0;  ///< [1/s]
  double k_velocity = 0.0;  ///< [N s/m] or [N m s/rad]
  double lower = 0.0, upper = 0.0;
};

/** Interval a velocity may lie in. */
struct VelocityBounds {
  double min = 0.0, max = 0.0;
};

/** min(max(value, low), high), as joint_limits_interface has it: high wins where low > high. */
double saturate(double value, double low, double high);

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

/** Velocities that soft limits leave at a position: -k_position (position - limit), within the velocity limit; all of
 * the velocity limit for joints without position limits. */
VelocityBounds softVelocityBounds(const JointLimits& limits, const SoftLimits& soft, double position);

/** Position command after joint_limits_interface::PositionJointSoftLimitsHandle, given the one of the period before. */
double softPositionCommand(const JointLimits& limits, const SoftLimits& soft, double command, double command_before,
                           double dt_s);

/** Velocities that VelocityJointSaturationHandle and VelocityJointSoftLimitsHandle leave at a state. */
VelocityBounds velocityCommandBounds(const JointLimits& limits, const SoftLimits& soft, double position,
                                     double velocity, double dt_s);

/** angles::shortest_angular_distance_with_large_limits: the shorter of the two turns that end on the angle `to` within
 *  the limits; the shortest of all if neither does. */
double angularDistanceWithin(double from, double to, double lower, double upper);

}  // namespace aras_visual_servo_sim
