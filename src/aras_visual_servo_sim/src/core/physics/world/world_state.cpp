// Saving and restoring a MultibodyWorld.
#include "aras_visual_servo_sim/config/archive.hpp"
#include "aras_visual_servo_sim/physics/multibody_world.hpp"
#include "physics/body/articulated_body.hpp"
#include "physics/body/driven_base.hpp"
#include "physics/contact/world_contacts.hpp"
#include "physics/drive/joint_drive.hpp"

namespace aras_visual_servo_sim {

namespace {

void visit(Archive& archive, FloatingBase& base) {
  Pose pose = base.pose();
  Twist velocity = base.velocity();
  archive(pose, velocity);
  base.restore(pose, velocity);
}

void visit(Archive& archive, WorldContacts& contacts) {
  for (std::size_t i = 0; i < contacts.obstacles().size(); ++i) {
    Pose pose = contacts.obstaclePose(i);
    archive(pose);
    contacts.restoreObstacle(i, pose);
  }
  for (FreeBody& body : contacts.freeBodies()) {
    Twist velocity = body.velocity();
    archive(velocity);
    body.restore(body.pose(), velocity);
  }
}

void visit(Archive& archive, DriveMemory& memory) {
  PidGains& gains = memory.gains;
  PidState& pid = memory.pid;
  archive(memory.set_point, memory.feed_forward, memory.effort_limit, memory.soft_position, memory.velocity_command,
          memory.process_value, memory.process_value_dot, memory.error, memory.command, memory.expiry_tick);
  archive(gains.p, gains.i, gains.d, gains.i_min, gains.i_max, gains.antiwindup);
  archive(pid.error, pid.last_error, pid.error_dot, pid.integral, pid.command, pid.last_error_valid);
}

}  // namespace

void MultibodyWorld::visitState(Archive& archive) {
  archive(ticks_);
  if (driven_) {
    driven_->visit(archive);
    followDriven();
    return;
  }
  archive(q_, v_, effort_, v_before_, base_before_);
  for (JointDrive& drive : drives_) visit(archive, drive.memory());
  if (body_->base()) visit(archive, *body_->base());
  if (contacts_) visit(archive, *contacts_);
}

std::string MultibodyWorld::signature() const {
  std::string text = model_.name + '\n' + numberText(config_.period_s) +
                     (driven_         ? " driven"
                      : body_->base() ? " floating"
                                      : "");
  if (contacts_) {
    for (const Obstacle& obstacle : contacts_->obstacles()) text += "\nsolid " + obstacle.name;
  }
  for (const auto& drive : drives_) {
    text += '\n' + drive.joint().name;
    for (const auto& controller : config_.controllers) {
      if (controller.joint == drive.joint().name)
        text += ' ' + controller.name + ' ' + controllerTypeName(controller.type);
    }
  }
  return text;
}

std::string MultibodyWorld::saveState() const {
  auto& self = const_cast<MultibodyWorld&>(*this);  // nothing changes where an archive writes
  Archive archive;
  std::string mine = signature();
  archive(mine);
  self.controllers_.visit(archive, model_);
  archive(self.link_pushes_, self.joint_pushes_);
  self.visitState(archive);
  return archive.bytes();
}

void MultibodyWorld::restoreState(const std::string& state) {
  Archive archive(state), whole;
  std::string found;
  ControllerSet controllers;
  std::map<int, Twist> link_pushes;
  std::map<int, double> joint_pushes;
  archive(found);
  if (found != signature()) {
    throw StateError("state: found " + std::to_string(state.size()) +
                     " bytes of another model or other controllers, must come from saveState() of a world like this");
  }
  controllers.visit(archive, model_);
  archive(link_pushes, joint_pushes);
  visitState(whole);
  if (archive.left() != whole.bytes().size()) {
    throw StateError("state: found " + std::to_string(archive.left()) + " bytes of joints and base, must be " +
                     std::to_string(whole.bytes().size()));
  }
  adopt(std::move(controllers));
  endPushes();
  link_pushes_ = std::move(link_pushes);
  joint_pushes_ = std::move(joint_pushes);
  visitState(archive);
  body_->setPositions(q_);
}

}  // namespace aras_visual_servo_sim
