#include "aras_visual_servo_sim/physics/managed/velocity_position_controller.hpp"

#include <cmath>
#include <utility>

#include "aras_visual_servo_sim/config/archive.hpp"
#include "aras_visual_servo_sim/config/section.hpp"

namespace aras_visual_servo_sim {
namespace {

constexpr double kTwoPi = 6.283185307179586476925;

std::unique_ptr<Controller> make(const std::string& name, const std::string& type, const YAML::Node& parameters,
                                 const RobotModel& model, std::vector<std::string>& warnings) {
  ControllerConfig drive;
  const auto settings = readController<VelocityPositionControllerConfig>(
      parameters, name, warnings, [&](const VelocityPositionControllerConfig& given, const SectionCheck& section) {
        drive.name = name;
        drive.joint = given.joint;
        drive.type = ControllerType::kVelocity;
        checkJoint(model, drive.joint, drive.type, name, section.faults());
      });
  drive.gains = gainsOf(settings.pid);
  const Joint& joint = model.movingJoint(model.jointIndex(drive.joint));
  return std::make_unique<VelocityPositionController>(name, type, std::move(drive), joint);
}

const RegisterController kType("velocity_controllers/JointPositionController", make);

}  // namespace

VelocityPositionController::VelocityPositionController(std::string name, std::string type, ControllerConfig drive,
                                                       const Joint& joint)
    : Controller(std::move(name), std::move(type), {std::move(drive)}),
      joint_type_(joint.type),
      limits_(joint.limits),
      pid_(drives().front().gains) {}

bool VelocityPositionController::takeCommand(double position) {
  if (!std::isfinite(position)) {
    throw NotFiniteError("controller '" + name() + "': position is not finite, must be finite");
  }
  set_point_ = clampPosition(limits_, position);
  return true;
}

bool VelocityPositionController::takeGains(const PidGains& gains) {
  checkGains(gains, name());
  pid_.setGains(gains);
  return true;
}

std::optional<ControllerState> VelocityPositionController::pidState() const {
  return ControllerState{set_point_, last_.position,       last_.velocity, pid_.state().error,
                         dt_s_,      pid_.state().command, pid_.gains()};
}

void VelocityPositionController::start(double, const std::vector<JointNow>& joints) {
  last_ = joints.front();
  set_point_ = clampPosition(limits_, last_.position);
  pid_.reset();
}

double VelocityPositionController::error(double position) const {
  const double plain = set_point_ - position;
  if (joint_type_ == JointType::kContinuous) return std::remainder(plain, kTwoPi);
  if (joint_type_ != JointType::kRevolute || limits_.upper - limits_.lower < kTwoPi) return plain;
  return angularDistanceWithin(position, set_point_, limits_.lower, limits_.upper);
}

void VelocityPositionController::update(double, double dt_s, const std::vector<JointNow>& joints,
                                        std::vector<JointTarget>& targets) {
  last_ = joints.front();
  dt_s_ = dt_s;
  targets.front().set_point = pid_.compute(error(last_.position), dt_s);
}

void VelocityPositionController::visit(Archive& archive) {
  PidGains gains = pid_.gains();
  PidState state = pid_.state();
  archive(gains.p, gains.i, gains.d, gains.i_min, gains.i_max, gains.antiwindup);
  archive(state.error, state.last_error, state.error_dot, state.integral, state.command, state.last_error_valid);
  archive(set_point_, dt_s_, last_.position, last_.velocity, last_.effort);
  pid_.setGains(gains);
  pid_.setState(state);
}

}  // namespace aras_visual_servo_sim
