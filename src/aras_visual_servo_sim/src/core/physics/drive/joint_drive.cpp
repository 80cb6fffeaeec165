#include "joint_drive.hpp"

#include <cmath>
#include <string>

#include "aras_visual_servo_sim/config/errors.hpp"

namespace aras_visual_servo_sim {

namespace {
constexpr double kTwoPi = 6.283185307179586476925;

/** Checks what joint_limits_interface's handles for soft limits require: velocity and effort limits. */
void checkSoftLimits(const Joint& joint, ControllerType type) {
  if (!joint.soft.present || type == ControllerType::kVelocity) return;
  const std::string what = "joint '" + joint.name + "': has soft limits and no ";
  if (!joint.enforced.has_velocity) throw ParameterError(what + "velocity limit, must have one");
  if (type == ControllerType::kPosition || joint.enforced.has_effort) return;
  throw ParameterError(what + "effort limit, must have one");
}

}  // namespace

JointDrive::JointDrive(const Joint& joint, const ControllerConfig* controller, Drive drive, double period_s)
    : joint_(joint), has_controller_(controller != nullptr), implicit_(drive == Drive::kImplicit), dt_s_(period_s) {
  if (controller) {
    controller_ = *controller;
    checkSoftLimits(joint_, controller_.type);
  }
  memory_.gains = controller_.gains;
}

void JointDrive::check(const ControllerConfig& controller) const { checkSoftLimits(joint_, controller.type); }

void JointDrive::engage(const ControllerConfig& controller, double q) {
  check(controller);
  controller_ = controller;
  has_controller_ = true;
  memory_.gains = controller_.gains;
  start(q);
}

void JointDrive::release() {
  controller_ = ControllerConfig{};
  has_controller_ = false;
  memory_ = DriveMemory{};
}

void JointDrive::aim(const JointTarget& target) {
  if (takesPosition()) {
    commandPosition(target.set_point);
  } else {
    memory_.set_point = controller_.type == ControllerType::kEffort ? target.set_point
                                                                    : clampVelocity(joint_.enforced, target.set_point);
  }
  memory_.feed_forward = target.feed_forward;
  memory_.effort_limit = target.effort_limit;
}

bool JointDrive::takesPosition() const {
  return has_controller_ &&
         (controller_.type == ControllerType::kEffortPosition || controller_.type == ControllerType::kPosition);
}

/** Shortest way round for a continuous joint, within the limits for a revolute one. */
double JointDrive::positionError(double q) const {
  const double error = memory_.set_point - q;
  if (joint_.type == JointType::kContinuous) return std::remainder(error, kTwoPi);
  // With limits less than a turn apart only the plain difference stays within them.
  const JointLimits& limits = joint_.limits;
  if (joint_.type != JointType::kRevolute || limits.upper - limits.lower < kTwoPi) return error;
  return angularDistanceWithin(q, memory_.set_point, limits.lower, limits.upper);
}

void JointDrive::start(double q) {
  const PidGains gains = memory_.gains;
  memory_ = DriveMemory{};
  memory_.gains = gains;
  if (takesPosition()) memory_.set_point = clampPosition(joint_.limits, q);
  memory_.process_value = controller_.type == ControllerType::kEffortVelocity ? 0.0 : q;
  // An implicit PID is evaluated at the end of a period; its evaluation at the start of the first one is this.
  if (implicit_) memory_.pid.last_error_valid = true;
}

void JointDrive::commandPosition(double set_point) {
  memory_.set_point = clampPosition(joint_.limits, set_point);
  memory_.velocity_command = 0.0;
}

void JointDrive::commandVelocity(double velocity, std::int64_t expiry_tick) {
  const double clamped = clampVelocity(joint_.enforced, velocity);
  (takesPosition() ? memory_.velocity_command : memory_.set_point) = clamped;
  memory_.expiry_tick = expiry_tick;
}

void JointDrive::commandEffort(double effort, std::int64_t expiry_tick) {
  memory_.set_point = effort;
  memory_.expiry_tick = expiry_tick;
}

/** The velocity commanded at a tick, 0 once the command is too old. */
double JointDrive::velocityTarget(std::int64_t tick) const {
  if (tick >= memory_.expiry_tick) return 0.0;
  return takesPosition() ? memory_.velocity_command : memory_.set_point;
}

void JointDrive::advanceSetPoint(std::int64_t tick) {
  if (!takesPosition() || memory_.velocity_command == 0.0) return;
  const double velocity = velocityTarget(tick);
  if (velocity == 0.0) {
    memory_.velocity_command = 0.0;
    return;
  }
  memory_.set_point = clampPosition(joint_.limits, memory_.set_point + velocity * dt_s_);
}

/** The PID at the end of the period as a function of the velocity v there; the error is `error` - `error_rate` v. */
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
    law = servoLaw(q, v, tick);
  } else if (type == ControllerType::kEffort) {
    if (tick >= memory_.expiry_tick) memory_.set_point = 0.0;
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
  if (memory_.feed_forward != 0.0) law.a0 += memory_.feed_forward;
  limitEffort(q, v, law);
  if (memory_.effort_limit < law.u_max) law.u_max = memory_.effort_limit;
  if (-memory_.effort_limit > law.u_min) law.u_min = -memory_.effort_limit;
  return law;
}

/** Position and velocity joints: the velocity that fulfils the command as the limits leave it. */
ActuatorLaw JointDrive::servoLaw(double q, double v, std::int64_t tick) {
  ActuatorLaw law;
  law.servo = true;
  if (controller_.type == ControllerType::kVelocity) {
    const VelocityBounds bounds = velocityCommandBounds(joint_.enforced, joint_.soft, q, v, dt_s_);
    law.servo_velocity = saturate(velocityTarget(tick), bounds.min, bounds.max);
    return law;
  }
  double error = error_before_;
  if (joint_.soft.present) {
    const double before = std::isnan(memory_.soft_position) ? q : memory_.soft_position;
    memory_.soft_position = softPositionCommand(joint_.enforced, joint_.soft, memory_.set_point, before, dt_s_);
    error = memory_.soft_position - q;
  }
  law.servo_velocity = clampVelocity(joint_.enforced, error / dt_s_);
  return law;
}

/** An implicit drive obeys what depends on the velocity at the end of the step, an explicit one at its beginning. */
void JointDrive::limitEffort(double q, double v, ActuatorLaw& law) const {
  if (joint_.soft.present && !law.servo) {
    const VelocityBounds bounds = softVelocityBounds(joint_.enforced, joint_.soft, q);
    const double effort = joint_.enforced.effort;
    law.u_min = -effort;
    law.u_max = effort;
    if (implicit_) {
      law.soft = true;
      law.soft_gain = joint_.soft.k_velocity;
      law.v_soft_low = bounds.min;
      law.v_soft_high = bounds.max;
    } else {
      law.u_min = saturate(-joint_.soft.k_velocity * (v - bounds.min), -effort, effort);
      law.u_max = saturate(-joint_.soft.k_velocity * (v - bounds.max), -effort, effort);
    }
    return;
  }
  const EffortBounds bounds = effortBounds(joint_.enforced, q, implicit_ ? 0.0 : v);
  law.u_min = bounds.min;
  law.u_max = bounds.max;
  if (implicit_ && joint_.enforced.has_velocity && !law.servo) law.v_max = joint_.enforced.velocity;
}

void JointDrive::prepare(double q, double v, std::int64_t tick, JointGraph& graph) {
  advanceSetPoint(tick);
  if (controller_.type == ControllerType::kEffortVelocity || controller_.type == ControllerType::kVelocity) {
    memory_.set_point = velocityTarget(tick);
  }
  error_before_ = takesPosition() ? positionError(q) : 0.0;
  const ActuatorLaw actuator = law(q, v, tick);
  const JointLimits& limits = joint_.limits;
  const double v_low = limits.has_position ? (limits.lower - q) / dt_s_ : -kInfinity;
  const double v_high = limits.has_position ? (limits.upper - q) / dt_s_ : kInfinity;
  // Static friction that falls with the speed would bend the graph upwards. Its size is that at the period's beginning.
  graph.build(actuator, joint_.damping, joint_.dryFriction(v), v_low, v_high);
}

void JointDrive::evaluate(double error, double process_value, double process_value_dot) {
  memory_.error = error;
  memory_.process_value = process_value;
  memory_.process_value_dot = process_value_dot;
  if (!hasPid(controller_.type)) {
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
  if (!implicit_ && hasPid(controller_.type)) return;  // done in law()
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
