// Controllers that are loaded, started and stopped while time goes on.
#include <utility>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "aras_visual_servo_sim/physics/multibody_world.hpp"
#include "physics/drive/joint_coupling.hpp"
#include "physics/drive/joint_drive.hpp"

namespace aras_visual_servo_sim {

/** What a joint does that no controller drives: it is passive, or stays where it is. */
void MultibodyWorld::idle(JointDrive& drive, double q) {
  drive.release();
  if (!config_.hold_idle_joints) return;
  for (const std::string& interface : drive.joint().hardware_interfaces) {
    const bool position = interface == "PositionJointInterface";
    if (!position && interface != "VelocityJointInterface") continue;
    ControllerConfig rest;
    rest.joint = drive.joint().name;
    rest.type = position ? ControllerType::kPosition : ControllerType::kVelocity;
    drive.engage(rest, q);
    return;
  }
}

void MultibodyWorld::idle(const Controller& controller) {
  for (const ControllerConfig& drive : controller.drives()) {
    idle(driveOfJoint(drive.joint), q_[model_.jointIndex(drive.joint)]);
  }
}

void MultibodyWorld::engage(const Controller& controller) {
  for (const ControllerConfig& drive : controller.drives()) {
    driveOfJoint(drive.joint).engage(drive, q_[model_.jointIndex(drive.joint)]);
  }
}

std::vector<JointNow> MultibodyWorld::jointsOf(const Controller& controller) const {
  std::vector<JointNow> joints;
  for (const ControllerConfig& drive : controller.drives()) {
    const int i = model_.jointIndex(drive.joint);
    joints.push_back({q_[i], v_[i], effort_[i]});
  }
  return joints;
}

/** To be called when other controllers run. */
void MultibodyWorld::listActing() {
  acting_.clear();
  for (auto& entry : controllers_.entries()) {
    if (!entry.running || !entry.controller->acts()) continue;
    Acting acting{entry.controller.get(), {}, {}, {}};
    for (const ControllerConfig& drive : entry.controller->drives()) {
      acting.joints.push_back(model_.jointIndex(drive.joint));
    }
    acting.now.resize(acting.joints.size());
    acting.targets.resize(acting.joints.size());
    acting_.push_back(std::move(acting));
  }
}

void MultibodyWorld::letControllersAct() {
  for (Acting& acting : acting_) {
    for (std::size_t k = 0; k < acting.joints.size(); ++k) {
      const int i = acting.joints[k];
      acting.now[k] = {q_[i], v_[i], effort_[i]};
    }
    acting.controller->update(timeS(), config_.period_s, acting.now, acting.targets);
    for (std::size_t k = 0; k < acting.joints.size(); ++k) {
      drives_[coupling_->coordinate(acting.joints[k])].aim(acting.targets[k]);
    }
  }
}

void MultibodyWorld::switchControllers(const std::vector<std::string>& start, const std::vector<std::string>& stop,
                                       bool strict) {
  std::map<std::string, std::string> taken;
  for (const ControllerConfig& each : config_.controllers) taken.emplace(each.joint, each.name);
  const ControllerSet::Switch plan = controllers_.plan(start, stop, strict, taken);
  for (const auto* entry : plan.start) {
    for (const ControllerConfig& drive : entry->controller->drives()) driveOfJoint(drive.joint).check(drive);
  }
  for (auto* entry : plan.stop) {
    entry->controller->stop();
    entry->running = false;
    idle(*entry->controller);
  }
  for (auto* entry : plan.start) {
    engage(*entry->controller);
    entry->controller->start(timeS(), jointsOf(*entry->controller));
    entry->running = entry->ran = true;
  }
  listActing();
}

void MultibodyWorld::adopt(ControllerSet next) {
  for (const auto& entry : controllers_.entries()) {
    if (entry.running) idle(*entry.controller);
  }
  controllers_ = std::move(next);
  for (const auto& entry : controllers_.entries()) {
    if (entry.running) engage(*entry.controller);
  }
  listActing();
}

void MultibodyWorld::restartControllers() {
  for (auto& entry : controllers_.entries()) {
    if (entry.running) entry.controller->start(timeS(), jointsOf(*entry.controller));
  }
}

Controller& MultibodyWorld::runningController(const std::string& name) {
  ControllerSet::Entry& entry = controllers_.entry(name, "command");
  if (!entry.running) {
    throw ParameterError("controller '" + name + "': Can't accept new commands. Controller is not running.");
  }
  return *entry.controller;
}

void MultibodyWorld::takeControllers(MultibodyWorld& other) {
  adopt(std::move(other.controllers_));
  other.adopt(ControllerSet());
  restartControllers();
}

void MultibodyWorld::setGroupCommand(const std::string& controller, const std::vector<double>& values) {
  const Controller& group = runningController(controller);
  if (values.size() != group.drives().size()) {
    throw ParameterError("controller '" + controller + "': Dimension of command (" + std::to_string(values.size()) +
                         ") does not match number of joints (" + std::to_string(group.drives().size()) +
                         ")! Not executing!");
  }
  std::vector<const JointDrive*> drives;
  for (const ControllerConfig& drive : group.drives()) drives.push_back(&driveOfJoint(drive.joint));
  takeValues(drives, values);
}

}  // namespace aras_visual_servo_sim
