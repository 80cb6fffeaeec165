#include "aras_visual_servo_sim/robot/joint_limits.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace aras_visual_servo_sim {

namespace {
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kTwoPi = 6.283185307179586476925;
}  // namespace

double saturate(double value, double low, double high) { return std::min(std::max(value, low), high); }

double clampPosition(const JointLimits& limits, double position) {
  return limits.has_position ? std::clamp(position, limits.lower, limits.upper) : position;
}

double clampVelocity(const JointLimits& limits, double velocity) {
  return limits.has_velocity ? std::clamp(velocity, -limits.velocity, limits.velocity) : velocity;
}

EffortBounds effortBounds(const JointLimits& limits, double position, double velocity) {
  const double effort = limits.has_effort ? limits.effort : kInfinity;
  EffortBounds bounds{-effort, effort};
  if (limits.has_position && position < limits.lower) bounds.min = 0.0;
  if (limits.has_position && position > limits.upper) bounds.max = 0.0;
  if (limits.has_velocity && velocity < -limits.velocity) bounds.min = 0.0;
  if (limits.has_velocity && velocity > limits.velocity) bounds.max = 0.0;
  return bounds;
}

VelocityBounds softVelocityBounds(const JointLimits& limits, const SoftLimits& soft, double position) {
  const double velocity = limits.has_velocity ? limits.velocity : kInfinity;
  if (!limits.has_position) return {-velocity, velocity};
  return {saturate(-soft.k_position * (position - soft.lower), -velocity, velocity),
          saturate(-soft.k_position * (position - soft.upper), -velocity, velocity)};
}

double softPositionCommand(const JointLimits& limits, const SoftLimits& soft, double command, double command_before,
                           double dt_s) {
  const VelocityBounds bounds = softVelocityBounds(limits, soft, command_before);
  double low = command_before + bounds.min * dt_s;
  double high = command_before + bounds.max * dt_s;
  if (limits.has_position) {
    low = std::max(low, limits.lower);
    high = std::min(high, limits.upper);
  }
  return saturate(command, low, high);
}

VelocityBounds velocityCommandBounds(const JointLimits& limits, const SoftLimits& soft, double position,
                                     double velocity, double dt_s) {
  VelocityBounds bounds{limits.has_velocity ? -limits.velocity : -kInfinity,
                        limits.has_velocity ? limits.velocity : kInfinity};
  if (soft.present) bounds = softVelocityBounds(limits, soft, position);
  if (limits.has_acceleration) {
    bounds.min = std::max(velocity - limits.acceleration * dt_s, bounds.min);
    bounds.max = std::min(velocity + limits.acceleration * dt_s, bounds.max);
  }
  return bounds;
}

double angularDistanceWithin(double from, double to, double lower, double upper) {
  const double shorter = std::remainder(to - from, kTwoPi);
  const double longer = shorter > 0.0 ? shorter - kTwoPi : shorter + kTwoPi;
  const auto within = [&](double turn) { return from + turn >= lower && from + turn <= upper; };
  return !within(shorter) && within(longer) ? longer : shorter;
}

}  // namespace aras_visual_servo_sim
