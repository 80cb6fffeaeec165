#include "aras_visual_servo_sim/joint_limits.hpp"

#include <algorithm>
#include <limits>

namespace aras_visual_servo_sim {

double clampPosition(const JointLimits& limits, double position) {
  return limits.has_position ? std::clamp(position, limits.lower, limits.upper) : position;
}

double clampVelocity(const JointLimits& limits, double velocity) {
  return limits.has_velocity ? std::clamp(velocity, -limits.velocity, limits.velocity) : velocity;
}

EffortBounds effortBounds(const JointLimits& limits, double position, double velocity) {
  const double effort = limits.has_effort ? limits.effort : std::numeric_limits<double>::infinity();
  EffortBounds bounds{-effort, effort};
  if (limits.has_position && position < limits.lower) bounds.min = 0.0;
  if (limits.has_position && position > limits.upper) bounds.max = 0.0;
  if (limits.has_velocity && velocity < -limits.velocity) bounds.min = 0.0;
  if (limits.has_velocity && velocity > limits.velocity) bounds.max = 0.0;
  return bounds;
}

}  // namespace aras_visual_servo_sim
