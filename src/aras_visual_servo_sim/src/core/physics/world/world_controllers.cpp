// Controllers that are loaded, started and stopped while time goes on.
#include <utility>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "world_impl.hpp"

namespace aras_visual_servo_sim {

/** What a joint does that no controller drives: it is passive, or stays where it is. */
void MultibodyWorld::Impl::idle(JointDrive& drive, double q) {
  drive.release();
  if (!config.hold_idle_joints) return;
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

std::vector<JointNow> MultibodyWorld::Impl::jointsOf(const Controller& controller) const {
  std::vector<JointNow> joints;
  for (const ControllerConfig& drive : controller.drives()) {
    const int i = model.jointIndex(drive.joint);
    joints.push_back({q[i], v[i], effort[i]});
  }
  return joints;
}

/** To be called when other controllers run. */
void MultibodyWorld::Impl::listActing() {
  acting_.clear();
  for (auto& entry : controllers.entries()) {
    if (!entry.running || !entry.controller->acts()) continue;
    Acting acting{entry.controller.get(), {}, {}, {}};
    for (const ControllerConfig& drive : entry.controller->drives()) {
      acting.joints.push_back(model.jointIndex(drive.joint));
    }
    acting.now.resize(acting.joints.size());
    acting.targets.resize(acting.joints.size());
    acting_.push_back(std::move(acting));
  }
}

void MultibodyWorld::Impl::letControllersAct() {
  for (Acting& acting : acting_) {
    for (std::size_t k = 0; k < acting.joints.size(); ++k) {
      const int i = acting.joints[k];
      acting.now[k] = {q[i], v[i], effort[i]};
    }
    acting.controller->update(timeS(), config.period_s, acting.now, acting.targets);
    for (std::size_t k = 0; k < acting.joints.size(); ++k) {
      drives[coupling.coordinate(acting.joints[k])].aim(acting.targets[k]);
    }
  }
}

void MultibodyWorld::Impl::switchControllers(const std::vector<std::string>& start,
                                             const std::vector<std::string>& stop, bool strict) {
  std::map<std::string, std::string> taken;
  for (const ControllerConfig& each : config.controllers) taken.emplace(each.joint, each.name);
  const ControllerSet::Switch plan = controllers.plan(start, stop, strict, taken);
  for (const auto* entry : plan.start) {
    for (const ControllerConfig& drive : entry->controller->drives()) driveOfJoint(drive.joint).check(drive);
  }
  for (auto* entry : plan.stop) {
    entry->controller->stop();
    entry->running = false;
    for (const ControllerConfig& drive : entry->controller->drives()) {
      idle(driveOfJoint(drive.joint), q[model.jointIndex(drive.joint)]);
    }
  }
  for (auto* entry : plan.start) {
    for (const ControllerConfig& drive : entry->controller->drives()) {
      driveOfJoint(drive.joint).engage(drive, q[model.jointIndex(drive.joint)]);
    }
    entry->controller->start(timeS(), jointsOf(*entry->controller));
    entry->running = entry->ran = true;
  }
  listActing();
}

void MultibodyWorld::Impl::adopt(ControllerSet next) {
  for (const auto& entry : controllers.entries()) {
    if (!entry.running) continue;
    for (const ControllerConfig& drive : entry.controller->drives()) {
      idle(driveOfJoint(drive.joint), q[model.jointIndex(drive.joint)]);
    }
  }
  controllers = std::move(next);
  for (const auto& entry : controllers.entries()) {
    if (!entry.running) continue;
    for (const ControllerConfig& drive : entry.controller->drives()) {
      driveOfJoint(drive.joint).engage(drive, q[model.jointIndex(drive.joint)]);
    }
  }
  listActing();
}

void MultibodyWorld::Impl::restartControllers() {
  for (auto& entry : controllers.entries()) {
    if (entry.running) entry.controller->start(timeS(), jointsOf(*entry.controller));
  }
}

Controller& MultibodyWorld::Impl::running(const std::string& name) {
  ControllerSet::Entry& entry = controllers.entry(name, "command");
  if (!entry.running) {
    throw ParameterError("controller '" + name + "': Can't accept new commands. Controller is not running.");
  }
  return *entry.controller;
}

std::vector<std::string> MultibodyWorld::loadController(const std::string& name, const YAML::Node& parameters) {
  return impl_->controllers.load(name, parameters, impl_->model);
}

void MultibodyWorld::unloadController(const std::string& name) { impl_->controllers.unload(name); }

void MultibodyWorld::switchControllers(const std::vector<std::string>& start, const std::vector<std::string>& stop,
                                       bool strict) {
  impl_->switchControllers(start, stop, strict);
}

const ControllerSet& MultibodyWorld::controllers() const { return impl_->controllers; }

void MultibodyWorld::takeControllers(MultibodyWorld& other) {
  impl_->adopt(std::move(other.impl_->controllers));
  other.impl_->adopt(ControllerSet());
  impl_->restartControllers();
}

Controller& MultibodyWorld::runningController(const std::string& name) { return impl_->running(name); }

std::vector<JointNow> MultibodyWorld::jointsOf(const Controller& controller) const {
  return impl_->jointsOf(controller);
}

void MultibodyWorld::setGroupCommand(const std::string& controller, const std::vector<double>& values) {
  const Controller& group = impl_->running(controller);
  if (values.size() != group.drives().size()) {
    throw ParameterError("controller '" + controller + "': Dimension of command (" + std::to_string(values.size()) +
                         ") does not match number of joints (" + std::to_string(group.drives().size()) +
                         ")! Not executing!");
  }
  JointCommand command;
  for (std::size_t k = 0; k < values.size(); ++k) {
    const JointDrive& drive = impl_->driveOfJoint(group.drives()[k].joint);
    (drive.takesPosition()   ? command.position
     : drive.takesVelocity() ? command.velocity
                             : command.effort)[drive.joint().name] = values[k];
  }
  impl_->command(command, false);
}

}  // namespace aras_visual_servo_sim
