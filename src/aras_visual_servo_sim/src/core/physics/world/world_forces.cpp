// Forces from outside, and what force and inertial sensors measure.
#include <cmath>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "aras_visual_servo_sim/physics/multibody_world.hpp"
#include "physics/body/articulated_body.hpp"

namespace aras_visual_servo_sim {

using Eigen::Matrix3d;
using Eigen::Vector3d;

Twist MultibodyWorld::baseAcceleration() const {
  if (!body_->base()) return Twist::Zero();
  return (body_->base()->velocity() - base_before_) / config_.period_s;
}

Vector3d MultibodyWorld::pushedPoint(int link) const { return body_->linkPose(link) * model_.links[link].com_m; }

void MultibodyWorld::letOutsidePush() {
  std::map<int, Twist> at_origins;
  for (const auto& [link, wrench] : link_pushes_) {
    Twist& moved = at_origins[link] = wrench;
    moved.tail<3>() += (pushedPoint(link) - body_->linkPose(link).p).cross(wrench.head<3>());
  }
  body_->push(at_origins, joint_pushes_);
}

void MultibodyWorld::endPushes() {
  if (link_pushes_.empty() && joint_pushes_.empty()) return;
  link_pushes_.clear();
  joint_pushes_.clear();
  letOutsidePush();
}

void MultibodyWorld::push(const std::map<std::string, Twist>& links, const std::map<std::string, double>& joints) {
  std::map<int, Twist> link_pushes;
  std::map<int, double> joint_pushes;
  for (const auto& [name, wrench] : links) {
    if (!wrench.allFinite()) throw NotFiniteError("link '" + name + "': a force is not finite, must be finite");
    link_pushes[model_.linkIndex(name)] = wrench;
  }
  for (const auto& [name, effort] : joints) {
    if (!std::isfinite(effort)) throw NotFiniteError("joint '" + name + "': an effort is not finite, must be finite");
    joint_pushes[model_.jointIndex(name)] = effort;
  }
  endPushes();
  link_pushes_ = std::move(link_pushes);
  joint_pushes_ = std::move(joint_pushes);
}

Twist MultibodyWorld::linkAcceleration(const std::string& link) const {
  const int index = model_.linkIndex(link);
  const Matrix3d R_LW = body_->linkPose(index).q.toRotationMatrix().transpose();
  const Twist a_W =
      driven_ ? Twist(Twist::Zero()) : body_->linkAcceleration(index, v_, acceleration(), baseAcceleration());
  Twist result;
  result << R_LW * a_W.head<3>(), R_LW * a_W.tail<3>();
  return result;
}

/** Newton and Euler for all links beyond the joint: what moves them, less what else pushes them. */
Twist MultibodyWorld::jointWrench(const std::string& joint) const {
  const Joint* found = nullptr;
  for (const Joint& each : model_.joints) {
    if (each.name == joint) found = &each;
  }
  if (!found) throw UnknownNameError("joint '" + joint + "' does not exist");
  std::vector<bool> beyond(model_.links.size(), false);
  const Pose X_WJ = body_->linkPose(found->child_link);
  const Eigen::VectorXd a = acceleration();
  const Twist base_a = baseAcceleration();
  Vector3d force = Vector3d::Zero(), torque = Vector3d::Zero();  // on the child, in world axes
  for (std::size_t i = 0; i < model_.links.size(); ++i) {        // parents first
    const Link& link = model_.links[i];
    const int index = static_cast<int>(i);
    beyond[i] =
        index == found->child_link ||
        (link.parent_joint >= 0 && beyond[static_cast<std::size_t>(model_.joints[link.parent_joint].parent_link)]);
    if (!beyond[i]) continue;
    const Pose X_WL = body_->linkPose(index);
    if (link.mass_kg > 0.0) {
      const Matrix3d R = X_WL.q.toRotationMatrix();
      const Twist twist = body_->linkTwist(index, v_);
      const Vector3d w = R * twist.tail<3>();
      const Twist acceleration = body_->linkAcceleration(index, v_, a, base_a);
      const Vector3d dw = acceleration.tail<3>();
      const Vector3d arm = R * link.com_m;
      const Vector3d pull =
          link.mass_kg * (acceleration.head<3>() + dw.cross(arm) + w.cross(w.cross(arm)) - config_.gravity_m_s2);
      const Matrix3d inertia = R * link.inertia_kg_m2 * R.transpose();
      force += pull;
      torque += inertia * dw + w.cross(inertia * w) + (X_WL.p + arm - X_WJ.p).cross(pull);
    }
    const auto outside = link_pushes_.find(index);
    if (outside == link_pushes_.end()) continue;
    force -= outside->second.head<3>();
    torque -= outside->second.tail<3>() + (pushedPoint(index) - X_WJ.p).cross(outside->second.head<3>());
  }
  for (const ContactForce& contact : contacts()) {
    for (const auto& [name, sign] : {std::pair(contact.a, 1.0), std::pair(contact.b, -1.0)}) {
      for (std::size_t i = 0; i < model_.links.size(); ++i) {
        if (!beyond[i] || model_.links[i].name != name) continue;
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
