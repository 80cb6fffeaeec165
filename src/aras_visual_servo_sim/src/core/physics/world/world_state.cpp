// Saving and restoring a MultibodyWorld.
#include "aras_visual_servo_sim/config/errors.hpp"
#include "aras_visual_servo_sim/physics/managed/memory.hpp"
#include "state_stream.hpp"
#include "world_impl.hpp"

namespace aras_visual_servo_sim {

namespace {

template <typename Stream>
void visitBase(Stream& stream, FloatingBase& base) {
  Pose pose = base.pose();
  Twist velocity = base.velocity();
  for (int k = 0; k < 3; ++k) stream.value(pose.p[k]);
  for (int k = 0; k < 4; ++k) stream.value(pose.q.coeffs()[k]);
  for (int k = 0; k < 6; ++k) stream.value(velocity[k]);
  base.restore(pose, velocity);
}

template <typename Stream>
void visitContacts(Stream& stream, WorldContacts& contacts) {
  for (std::size_t i = 0; i < contacts.obstacles().size(); ++i) {
    Pose pose = contacts.obstaclePose(i);
    for (int k = 0; k < 3; ++k) stream.value(pose.p[k]);
    for (int k = 0; k < 4; ++k) stream.value(pose.q.coeffs()[k]);
    contacts.restoreObstacle(i, pose);
  }
  for (FreeBody& body : contacts.freeBodies()) {
    Twist velocity = body.velocity();
    for (int k = 0; k < 6; ++k) stream.value(velocity[k]);
    body.restore(body.pose(), velocity);
  }
}

template <typename Stream>
void visitMemory(Stream& stream, DriveMemory& memory) {
  for (double* value :
       {&memory.set_point, &memory.feed_forward, &memory.effort_limit, &memory.soft_position, &memory.velocity_command,
        &memory.process_value, &memory.process_value_dot, &memory.error, &memory.command, &memory.gains.p,
        &memory.gains.i, &memory.gains.d, &memory.gains.i_min, &memory.gains.i_max, &memory.pid.error,
        &memory.pid.last_error, &memory.pid.error_dot, &memory.pid.integral, &memory.pid.command}) {
    stream.value(*value);
  }
  stream.value(memory.expiry_tick);
  stream.value(memory.gains.antiwindup);
  stream.value(memory.pid.last_error_valid);
}

void readPushes(MemoryReader& in, std::map<int, Twist>& links, std::map<int, double>& joints) {
  for (auto left = in.count(); left > 0; --left) {
    int link = 0;
    in.get(link);
    for (int k = 0; k < 6; ++k) in.get(links[link][k]);
  }
  for (auto left = in.count(); left > 0; --left) {
    int joint = 0;
    in.get(joint);
    in.get(joints[joint]);
  }
}

}  // namespace

void MultibodyWorld::Impl::savePushes(MemoryWriter& out) const {
  out.put<std::uint64_t>(link_pushes.size());
  for (const auto& [link, wrench] : link_pushes) {
    out.put(link);
    for (int k = 0; k < 6; ++k) out.put(wrench[k]);
  }
  out.put<std::uint64_t>(joint_pushes.size());
  for (const auto& [joint, effort] : joint_pushes) {
    out.put(joint);
    out.put(effort);
  }
}

template <typename Stream>
void MultibodyWorld::Impl::visitState(Stream& stream) {
  stream.value(ticks);
  if (driven) {
    driven->visit(stream);
    followDriven();
    return;
  }
  for (int i = 0; i < model.dofs(); ++i) {
    stream.value(q[i]);
    stream.value(v[i]);
    stream.value(effort[i]);
  }
  for (int i = 0; i < model.dofs(); ++i) stream.value(v_before[i]);
  for (int k = 0; k < 6; ++k) stream.value(base_before[k]);
  for (auto& drive : drives) visitMemory(stream, drive.memory());
  if (body.base()) visitBase(stream, *body.base());
  if (contacts) visitContacts(stream, *contacts);
}

std::string MultibodyWorld::Impl::signature() const {
  std::string text = model.name + '\n' + shown(config.period_s) + (driven ? " driven" : body.base() ? " floating" : "");
  if (contacts) {
    for (const Obstacle& obstacle : contacts->obstacles()) text += "\nsolid " + obstacle.name;
  }
  for (const auto& drive : drives) {
    text += '\n' + drive.joint().name;
    for (const auto& controller : config.controllers) {
      if (controller.joint == drive.joint().name)
        text += ' ' + controller.name + ' ' + controllerTypeName(controller.type);
    }
  }
  return text;
}

std::string MultibodyWorld::saveState() const {
  ByteWriter writer;
  writer.text(impl_->signature());
  impl_->visitState(writer);
  MemoryWriter controllers;
  impl_->controllers.save(controllers);
  impl_->savePushes(controllers);
  return writer.bytes() + controllers.bytes();
}

void MultibodyWorld::restoreState(const std::string& state) {
  ByteWriter mine;
  mine.text(impl_->signature());
  ByteWriter whole = mine;
  impl_->visitState(whole);
  if (state.size() < whole.bytes().size() || state.compare(0, mine.bytes().size(), mine.bytes()) != 0) {
    throw StateError("state: found " + std::to_string(state.size()) +
                     " bytes of another model or other controllers, must come from saveState() of a world like this");
  }
  MemoryReader loaded(state, whole.bytes().size());
  ControllerSet controllers = ControllerSet::restored(loaded, impl_->model);
  std::map<int, Twist> link_pushes;
  std::map<int, double> joint_pushes;
  readPushes(loaded, link_pushes, joint_pushes);
  if (!loaded.atEnd()) throw StateError("state: found bytes after its end, must be of a world like this");
  impl_->adopt(std::move(controllers));
  impl_->endPushes();
  impl_->link_pushes = std::move(link_pushes);
  impl_->joint_pushes = std::move(joint_pushes);
  ByteReader reader(state, mine.bytes().size());
  impl_->visitState(reader);
  impl_->body.setPositions(impl_->q);
}

}  // namespace aras_visual_servo_sim
