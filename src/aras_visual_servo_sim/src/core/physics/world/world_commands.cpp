// Commands to the joints, or to a driven base, and the drives that take them.
#include <cmath>
#include <utility>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "aras_visual_servo_sim/config/section.hpp"
#include "aras_visual_servo_sim/physics/multibody_world.hpp"
#include "physics/body/articulated_body.hpp"
#include "physics/body/driven_base.hpp"
#include "physics/drive/joint_coupling.hpp"
#include "physics/drive/joint_drive.hpp"

namespace aras_visual_servo_sim {

namespace {

/** A timeout of this many periods or more counts as none; the number is far below the largest tick. */
constexpr double kLongestTimeout = 1e18;

}  // namespace

/** The first tick at or after the timeout; the small slack keeps 0.1 s / 0.001 s at 100. */
std::int64_t MultibodyWorld::expiryTick(double timeout_s) const {
  const double periods = std::ceil(timeout_s / config_.period_s - 1e-9);
  return timeout_s > 0.0 && periods < kLongestTimeout ? ticks_ + static_cast<std::int64_t>(periods) : kNever;
}

const JointDrive& MultibodyWorld::driveOf(int joint) const { return drives_[coupling_->coordinate(joint)]; }

const JointDrive& MultibodyWorld::driveOfJoint(const std::string& name) const {
  const int joint = model_.jointIndex(name);
  if (coupling_->follows(joint)) {
    throw ParameterError("joint '" + name + "': mimics '" + driveOf(joint).joint().name +
                         "', must be moved through that joint");
  }
  return driveOf(joint);
}

JointDrive& MultibodyWorld::driveOfJoint(const std::string& name) {
  return const_cast<JointDrive&>(std::as_const(*this).driveOfJoint(name));
}

const JointDrive& MultibodyWorld::driveOf(const std::string& controller) const {
  std::string known;
  for (const auto& drive : drives_) {
    if (!drive.hasController() || drive.controller().name.empty()) continue;
    if (drive.controller().name == controller) return drive;
    known += (known.empty() ? "" : ", ") + drive.controller().name;
  }
  throw UnknownNameError("controller '" + controller + "' does not exist, allowed: " + known);
}

void MultibodyWorld::checkCommand(const std::map<std::string, double>& values, bool (JointDrive::*takes)() const,
                                  const char* kind) const {
  for (const auto& item : values) {
    const JointDrive& drive = driveOfJoint(item.first);
    if (std::isfinite(item.second) && (drive.*takes)()) continue;
    const std::string what = "joint '" + item.first + "': " + kind + " command is " + numberText(item.second);
    if (!std::isfinite(item.second)) throw NotFiniteError(what + ", must be finite");
    throw ParameterError(what + ", must be one its controller takes (" +
                         (drive.hasController() ? controllerTypeName(drive.controller().type) : "it has none") + ")");
  }
}

std::map<int, double> MultibodyWorld::drivenValues(const std::map<std::string, double>& values,
                                                   const char* kind) const {
  std::map<int, double> checked;
  for (const auto& [name, value] : values) {
    checked[DrivenBase::index(name)] = value;
    if (std::isfinite(value)) continue;
    throw NotFiniteError("joint '" + name + "': " + kind + " is " + numberText(value) + ", must be finite");
  }
  return checked;
}

void MultibodyWorld::commandDriven(const JointCommand& command, bool expires) {
  const auto positions = drivenValues(command.position, "position command");
  const auto velocities = drivenValues(command.velocity, "velocity command");
  if (!command.effort.empty()) {
    throw ParameterError("joint '" + command.effort.begin()->first +
                         "': found an effort command, a driven base takes position and velocity");
  }
  if (!positions.empty()) {
    driven_->place(positions);
    followDriven();
  }
  if (velocities.empty()) return;
  driven_->command(velocities, ticks_, expires ? expiryTick(config_.command_timeout_s) : kNever);
}

void MultibodyWorld::takeCommand(const JointCommand& command, bool expires) {
  if (driven_) return commandDriven(command, expires);
  checkCommand(command.position, &JointDrive::takesPosition, "position");
  checkCommand(command.velocity, &JointDrive::takesVelocity, "velocity");
  checkCommand(command.effort, &JointDrive::takesEffort, "effort");
  for (const auto& item : command.position) driveOfJoint(item.first).commandPosition(item.second);
  for (const auto& item : command.velocity) {
    JointDrive& drive = driveOfJoint(item.first);
    drive.commandVelocity(item.second,
                          expiryTick(expires ? config_.command_timeout_s : drive.controller().command_timeout_s));
  }
  for (const auto& item : command.effort) {
    JointDrive& drive = driveOfJoint(item.first);
    drive.commandEffort(item.second, expiryTick(drive.controller().command_timeout_s));
  }
}

JointCommand MultibodyWorld::twistCommand(const Twist& V_WL_L, const std::string& link) const {
  if (!driven_) throw ParameterError("twist command: the base is not driven (sim/base: driven)");
  Twist V_WB_B = V_WL_L;
  if (!link.empty()) {
    const int index = model_.linkIndex(link);
    if (!body_->moves(index)) {
      throw ParameterError("twist command: found frame '" + link + "', allowed is a link that the driven base carries");
    }
    const Pose X_BL = driven_->pose().inverse() * body_->linkPose(index);
    V_WB_B << X_BL.q * V_WL_L.head<3>(), X_BL.q * V_WL_L.tail<3>();
    V_WB_B.head<3>() -= V_WB_B.tail<3>().cross(X_BL.p);
  }
  JointCommand command;
  for (int k = 0; k < 6; ++k) command.velocity[DrivenBase::coordinates()[k]] = V_WB_B[k];
  return command;
}

void MultibodyWorld::hold() {
  JointCommand rest;
  if (driven_) {
    for (const std::string& name : jointNames()) rest.velocity[name] = 0.0;
    return setCommand(rest);
  }
  for (const ControllerConfig& controller : config_.controllers) {
    if (controller.type != ControllerType::kEffort) setVelocity(controller.joint, 0.0);
  }
}

/** Takes a value for each drive, as its controller has it; no timeout. */
void MultibodyWorld::takeValues(const std::vector<const JointDrive*>& drives, const std::vector<double>& values) {
  JointCommand command;
  for (std::size_t k = 0; k < drives.size(); ++k) {
    const JointDrive& drive = *drives[k];
    (drive.takesPosition()   ? command.position
     : drive.takesVelocity() ? command.velocity
                             : command.effort)[drive.joint().name] = values[k];
  }
  takeCommand(command, false);
}

/** The controller of this name, if it was loaded and runs; else null. */
Controller* MultibodyWorld::findRunning(const std::string& name) const {
  for (const auto& entry : controllers_.entries()) {
    if (entry.running && entry.controller->name() == name) return entry.controller.get();
  }
  return nullptr;
}

void MultibodyWorld::setControllerCommand(const std::string& controller, double value) {
  if (Controller* running = findRunning(controller); running && running->takeCommand(value)) return;
  takeValues({&driveOf(controller)}, {value});
}

std::vector<std::string> MultibodyWorld::controllerNames() const {
  std::vector<std::string> names;
  for (const auto& controller : config_.controllers) names.push_back(controller.name);
  return names;
}

const ControllerConfig& MultibodyWorld::controllerConfig(const std::string& controller) const {
  return driveOf(controller).controller();
}

ControllerState MultibodyWorld::controllerState(const std::string& controller) const {
  const Controller* running = findRunning(controller);
  if (const auto state = running ? running->pidState() : std::nullopt) return *state;
  const DriveMemory& memory = driveOf(controller).memory();
  return {memory.set_point, memory.process_value, memory.process_value_dot, memory.error, config_.period_s,
          memory.command,   memory.gains};
}

void MultibodyWorld::setGains(const std::string& controller, const PidGains& gains) {
  if (Controller* running = findRunning(controller); running && running->takeGains(gains)) return;
  auto& drive = const_cast<JointDrive&>(driveOf(controller));
  checkGains(gains, controller);
  drive.memory().gains = gains;
}

}  // namespace aras_visual_servo_sim
