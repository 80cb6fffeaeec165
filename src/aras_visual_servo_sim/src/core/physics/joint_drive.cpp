#include "joint_drive.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace aras_visual_servo_sim {

namespace {
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kTwoPi = 6.283185307179586476925;
}  // namespace

JointDrive::JointDrive(const Joint& joint, const ControllerConfig* controller, Drive drive, double period_s,
                       std::int64_t timeout_ticks)
    : joint_(joint),
      has_controller_(controller != nullptr),
      implicit_(drive == Drive::kImplicit),
      dt_s_(period_s),
      timeout_ticks_(timeout_ticks) {
  if (controller) controller_ = *controller;
  memory_.gains = controller_.gains;
}

bool JointDrive::positionControlled() const {
  return has_controller_ &&
         (controller_.type == ControllerType::kEffortPosition || controller_.type == ControllerType::kPosition);
}

bool JointDrive::hasPid() const {
  return has_controller_ &&
         (controller_.type == ControllerType::kEffortPosition || controller_.type == ControllerType::kEffortVelocity);
}

bool JointDrive::takesPosition() const { return positionControlled(); }
bool JointDrive::takesVelocity() const { return has_controller_ && controller_.type != ControllerType::kEffort; }
bool JointDrive::takesEffort() const { return has_controller_ && controller_.type == ControllerType::kEffort; }

/** Shortest way round for a continuous joint, the plain difference otherwise. */
double JointDrive::positionError(double q) const {
  const double error = memory_.set_point - q;
  return joint_.type == JointType::kContinuous ? std::remainder(error, kTwoPi) : error;
}

void JointDrive::start(double q) {
  const PidGains gains = memory_.gains;
  memory_ = DriveMemory{};
  memory_.gains = gains;
  if (positionControlled()) memory_.set_point = clampPosition(joint_.limits, q);
  memory_.process_value = controller_.type == ControllerType::kEffortVelocity ? 0.0 : q;
  // An implicit PID is evaluated at the end of a period; its evaluation at the start of the first one is this.
  if (implicit_) memory_.pid.last_error_valid = true;
}

void JointDrive::commandPosition(double set_point) {
  memory_.set_point = clampPosition(joint_.limits, set_point);
  memory_.velocity_command = 0.0;
}

void JointDrive::commandVelocity(double velocity, std::int64_t tick, bool expires) {
  const double clamped = clampVelocity(joint_.limits, velocity);
  (positionControlled() ? memory_.velocity_command : memory_.set_point) = clamped;
  memory_.command_tick = tick;
  memory_.expires = expires;
}

void JointDrive::commandEffort(double effort) { memory_.set_point = effort; }

/** The velocity commanded at a tick, 0 once the command is too old. */
double JointDrive::velocityTarget(std::int64_t tick) const {
  if (memory_.expires && timeout_ticks_ > 0 && tick - memory_.command_tick >= timeout_ticks_) return 0.0;
  return positionControlled() ? memory_.velocity_command : memory_.set_point;
}

void JointDrive::advanceSetPoint(std::int64_t tick) {
  if (!positionControlled() || memory_.velocity_command == 0.0) return;
  const double velocity = velocityTarget(tick);
  if (velocity == 0.0) {
    memory_.velocity_command = 0.0;
    return;
  }
  memory_.set_point = clampPosition(joint_.limits, memory_.set_point + velocity * dt_s_);
}

/** The PID at the end of the period as a function of the velocity v there, where the error is `error` - `error_rate` v.
 */
ActuatorLaw JointDrive::implicitPid(double error, double error_rate) const {
  const PidGains& gains = memory_.gains;
  const PidState& state = memory_.pid;
  ActuatorLaw law;
  law.a0 = gains.p * error;
  law.a1 = gains.p * error_rate;
  if (state.last_error_valid) {
    law.a0 += gains.d * ((error - state.last_error) / dt_s_);
    law.a1 += gains.d * (error_rate / dt_s_);
  } else {
    law.a0 += gains.d * state.error_dot;
  }
  if (gains.i != 0.0 && gains.i_min < gains.i_max) {
    law.b0 = gains.i * (state.integral + dt_s_ * error);
    law.b1 = gains.i * (dt_s_ * error_rate);
    law.b_min = gains.i_min;
    law.b_max = gains.i_max;
  }
  return law;
}

ActuatorLaw JointDrive::law(double q, double v, std::int64_t tick) {
  ActuatorLaw law;
  if (!has_controller_) return law;
  const ControllerType type = controller_.type;
  if (type == ControllerType::kPosition || type == ControllerType::kVelocity) {
    law.servo = true;
    const double target = type == ControllerType::kPosition ? error_before_ / dt_s_ : velocityTarget(tick);
    law.servo_velocity = clampVelocity(joint_.limits, target);
  } else if (type == ControllerType::kEffort) {
    law.a0 = memory_.set_point;
  } else if (!implicit_) {
    const double error = type == ControllerType::kEffortPosition ? error_before_ : velocityTarget(tick) - v;
    evaluate(error, type == ControllerType::kEffortPosition ? q : v, v);
    law.a0 = memory_.command;
  } else if (type == ControllerType::kEffortPosition) {
    law = implicitPid(error_before_, dt_s_);
  } else {
    law = implicitPid(velocityTarget(tick), 1.0);
  }
  const EffortBounds bounds = implicit_ ? effortBounds(joint_.limits, q, 0.0) : effortBounds(joint_.limits, q, v);
  law.u_min = bounds.min;
  law.u_max = bounds.max;
  if (implicit_ && joint_.limits.has_velocity && !law.servo) law.v_max = joint_.limits.velocity;
  return law;
}

void JointDrive::prepare(double q, double v, std::int64_t tick, JointGraph& graph) {
  advanceSetPoint(tick);
  if (controller_.type == ControllerType::kEffortVelocity || controller_.type == ControllerType::kVelocity) {
    memory_.set_point = velocityTarget(tick);
  }
  error_before_ = positionControlled() ? positionError(q) : 0.0;
  const ActuatorLaw actuator = law(q, v, tick);
  const JointLimits& limits = joint_.limits;
  const double v_low = limits.has_position ? (limits.lower - q) / dt_s_ : -kInfinity;
  const double v_high = limits.has_position ? (limits.upper - q) / dt_s_ : kInfinity;
  graph.build(actuator, joint_.damping, joint_.friction, v_low, v_high);
}

void JointDrive::evaluate(double error, double process_value, double process_value_dot) {
  memory_.error = error;
  memory_.process_value = process_value;
  memory_.process_value_dot = process_value_dot;
  if (!hasPid()) {
    memory_.command = memory_.set_point;
    return;
  }
  Pid pid(memory_.gains);
  pid.setState(memory_.pid);
  memory_.command = pid.compute(error, dt_s_);
  memory_.pid = pid.state();
}

void JointDrive::finish(double q, double v, double v_before) {
  if (!has_controller_) return;
  if (!implicit_ && hasPid()) return;  // done in law()
  switch (controller_.type) {
    case ControllerType::kEffortPosition:
    case ControllerType::kPosition:
      return evaluate(error_before_ - dt_s_ * v, q, v);
    case ControllerType::kEffortVelocity:
    case ControllerType::kVelocity:
      return evaluate(memory_.set_point - v, v, (v - v_before) / dt_s_);
    case ControllerType::kEffort:
      return evaluate(0.0, q, v);
  }
}

}  // namespace aras_visual_servo_sim
