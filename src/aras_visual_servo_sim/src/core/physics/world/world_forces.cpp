// Forces from outside, and what force and inertial sensors measure.
#include <cmath>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "world_impl.hpp"

namespace aras_visual_servo_sim {

using Eigen::Matrix3d;
using Eigen::Vector3d;

Twist MultibodyWorld::Impl::baseAcceleration() const {
  if (!body.base()) return Twist::Zero();
  return (body.base()->velocity() - base_before) / config.period_s;
}

Vector3d MultibodyWorld::Impl::pushedPoint(int link) const { return body.linkPose(link) * model.links[link].com_m; }

void MultibodyWorld::Impl::letOutsidePush() {
  std::map<int, Twist> at_origins;
  for (const auto& [link, wrench] : link_pushes) {
    Twist& moved = at_origins[link] = wrench;
    moved.tail<3>() += (pushedPoint(link) - body.linkPose(link).p).cross(wrench.head<3>());
  }
  body.push(at_origins, joint_pushes);
}

void MultibodyWorld::Impl::endPushes() {
  if (link_pushes.empty() && joint_pushes.empty()) return;
  link_pushes.clear();
  joint_pushes.clear();
  letOutsidePush();
}

void MultibodyWorld::push(const std::map<std::string, Twist>& links, const std::map<std::string, double>& joints) {
  std::map<int, Twist> link_pushes;
  std::map<int, double> joint_pushes;
  for (const auto& [name, wrench] : links) {
    if (!wrench.allFinite()) throw NotFiniteError("link '" + name + "': a force is not finite, must be finite");
    link_pushes[impl_->model.linkIndex(name)] = wrench;
  }
  for (const auto& [name, effort] : joints) {
    if (!std::isfinite(effort)) throw NotFiniteError("joint '" + name + "': an effort is not finite, must be finite");
    joint_pushes[impl_->model.jointIndex(name)] = effort;
  }
  impl_->endPushes();
  impl_->link_pushes = std::move(link_pushes);
  impl_->joint_pushes = std::move(joint_pushes);
}

Twist MultibodyWorld::linkAcceleration(const std::string& link) const {
  const int index = impl_->model.linkIndex(link);
  const Matrix3d R_LW = impl_->body.linkPose(index).q.toRotationMatrix().transpose();
  const Twist a_W =
      impl_->driven ? Twist(Twist::Zero())
                    : impl_->body.linkAcceleration(index, impl_->v, impl_->acceleration(), impl_->baseAcceleration());
  Twist result;
  result << R_LW * a_W.head<3>(), R_LW * a_W.tail<3>();
  return result;
}

/** Newton and Euler for all links beyond the joint: what moves them, less what else pushes them. */
Twist MultibodyWorld::jointWrench(const std::string& joint) const {
  const RobotModel& model = impl_->model;
  const Joint* found = nullptr;
  for (const Joint& each : model.joints) {
    if (each.name == joint) found = &each;
  }
  if (!found) throw UnknownNameError("joint '" + joint + "' does not exist");
  std::vector<bool> beyond(model.links.size(), false);
  const Pose X_WJ = impl_->body.linkPose(found->child_link);
  const Eigen::VectorXd a = impl_->acceleration();
  const Twist base_a = impl_->baseAcceleration();
  Vector3d force = Vector3d::Zero(), torque = Vector3d::Zero();  // on the child, in world axes
  for (std::size_t i = 0; i < model.links.size(); ++i) {         // parents first
    const Link& link = model.links[i];
    const int index = static_cast<int>(i);
    beyond[i] =
        index == found->child_link ||
        (link.parent_joint >= 0 && beyond[static_cast<std::size_t>(model.joints[link.parent_joint].parent_link)]);
    if (!beyond[i]) continue;
    const Pose X_WL = impl_->body.linkPose(index);
    if (link.mass_kg > 0.0) {
      const Matrix3d R = X_WL.q.toRotationMatrix();
      const Twist twist = impl_->body.linkTwist(index, impl_->v);
      const Vector3d w = R * twist.tail<3>();
      const Twist acceleration = impl_->body.linkAcceleration(index, impl_->v, a, base_a);
      const Vector3d dw = acceleration.tail<3>();
      const Vector3d arm = R * link.com_m;
      const Vector3d pull =
          link.mass_kg * (acceleration.head<3>() + dw.cross(arm) + w.cross(w.cross(arm)) - impl_->config.gravity_m_s2);
      const Matrix3d inertia = R * link.inertia_kg_m2 * R.transpose();
      force += pull;
      torque += inertia * dw + w.cross(inertia * w) + (X_WL.p + arm - X_WJ.p).cross(pull);
    }
    const auto outside = impl_->link_pushes.find(index);
    if (outside == impl_->link_pushes.end()) continue;
    force -= outside->second.head<3>();
    torque -= outside->second.tail<3>() + (impl_->pushedPoint(index) - X_WJ.p).cross(outside->second.head<3>());
  }
  for (const ContactForce& contact : contacts()) {
    for (const auto& [name, sign] : {std::pair(contact.a, 1.0), std::pair(contact.b, -1.0)}) {
      for (std::size_t i = 0; i < model.links.size(); ++i) {
        if (!beyond[i] || model.links[i].name != name) continue;
        force -= sign * contact.force_W;
        torque -= sign * (contact.point_W - X_WJ.p).cross(contact.force_W);
      }
    }
  }
  const Matrix3d R_JW = X_WJ.q.toRotationMatrix().transpose();
  Twist result;
  result << -(R_JW * force), -(R_JW * torque);
  return result;
}

}  // namespace aras_visual_servo_sim
