// The part of ArticulatedBody that sensors read and that is pushed from outside.
#include <vector>

#include "articulated_body.hpp"
#include "physics/bullet/to_bullet.hpp"

namespace aras_visual_servo_sim {

using Eigen::Vector3d;

void ArticulatedBody::push(const std::map<int, Twist>& links, const std::map<int, double>& joints) {
  bullet_->clearForcesAndTorques();
  for (int i = 0; i < dofs(); ++i) {
    bullet_->addLinkForce(i, toBullet(gravity_m_s2_) * bodies_[i].mass_kg);
    const auto effort = joints.find(bodies_[i].index);
    if (effort != joints.end()) bullet_->addJointTorque(i, effort->second);
  }
  if (base_) bullet_->addBaseForce(toBullet(gravity_m_s2_) * base_body_.mass_kg);
  for (const auto& [link, wrench] : links) {
    if (!moves(link)) continue;
    const int body = link_body_[link];
    const Vector3d com = body == kOnBase ? base_->com() : frames_[body].com;
    const Vector3d force = wrench.head<3>();
    const Vector3d torque = wrench.tail<3>() + (linkPose(link).p - com).cross(force);
    if (body == kOnBase) {
      bullet_->addBaseForce(toBullet(force));
      bullet_->addBaseTorque(toBullet(torque));
    } else {
      bullet_->addLinkForce(body, toBullet(force));
      bullet_->addLinkTorque(body, toBullet(torque));
    }
  }
}

Twist ArticulatedBody::linkAcceleration(int link, const Eigen::VectorXd& v, const Eigen::VectorXd& a,
                                        const Twist& base_a) const {
  Vector3d p = Vector3d::Zero(), w = Vector3d::Zero(), linear = Vector3d::Zero(), angular = Vector3d::Zero();
  if (base_ && link_body_[link] != kOnWorld) {
    p = base_->com();
    w = base_->velocity().tail<3>();
    linear = base_a.head<3>();
    angular = base_a.tail<3>();
  }
  const auto moveTo = [&](const Vector3d& next) {
    const Vector3d arm = next - p;
    linear += angular.cross(arm) + w.cross(w.cross(arm));
    p = next;
  };
  std::vector<int> chain;
  for (int body = link_body_[link]; body >= 0; body = bodies_[body].parent) chain.push_back(body);
  for (auto body = chain.rbegin(); body != chain.rend(); ++body) {
    const Frame& frame = frames_[*body];
    const double rate = v[bodies_[*body].index];
    const double change = a[bodies_[*body].index];
    moveTo(frame.p);
    if (bodies_[*body].prismatic) {
      linear += change * frame.axis + 2.0 * rate * w.cross(frame.axis);
    } else {
      angular += change * frame.axis + rate * w.cross(frame.axis);
      w += rate * frame.axis;
    }
  }
  moveTo(linkPose(link).p);
  Twist result;
  result << linear, angular;
  return result;
}

}  // namespace aras_visual_servo_sim
