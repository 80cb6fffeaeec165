// The part of ArticulatedBody that is Bullet's, motion without joint effort, and what sensors read.
#include <Eigen/Eigenvalues>
#include <limits>
#include <vector>

#include "articulated_body.hpp"
#include "physics/bullet/to_bullet.hpp"

namespace aras_visual_servo_sim {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

namespace {

/** Right-handed principal axes of an inertia tensor, moments in `moments`. */
Matrix3d principalAxes(const Matrix3d& inertia, Vector3d& moments) {
  const Eigen::SelfAdjointEigenSolver<Matrix3d> solver(inertia);
  moments = solver.eigenvalues();
  Matrix3d R = solver.eigenvectors();
  if (R.determinant() < 0.0) R.col(2) = -R.col(2);
  return R;
}

}  // namespace

void ArticulatedBody::buildBullet() {
  const int n = dofs();
  Vector3d base_moments = Vector3d::Ones();
  if (base_) R_base_principal_ = principalAxes(base_body_.inertia_kg_m2, base_moments);
  bullet_ = std::make_unique<btMultiBody>(n, base_ ? base_body_.mass_kg : 1.0, toBullet(base_moments), !base_, false);
  bullet_->setBaseWorldTransform(btTransform::getIdentity());
  std::vector<Matrix3d> R_principal(n);
  for (int i = 0; i < n; ++i) {
    const Body& body = bodies_[i];
    Vector3d moments = Vector3d::Zero();
    R_principal[i] = body.mass_kg > 0.0 ? principalAxes(body.inertia_kg_m2, moments) : Matrix3d::Identity();
    const Matrix3d& R = R_principal[i];
    const Matrix3d R_parent = body.parent < 0 ? R_base_principal_ : R_principal[body.parent];
    const Vector3d com_parent = body.parent < 0 ? base_body_.com_m : bodies_[body.parent].com_m;
    const btQuaternion parent_to_this = toBullet(Quaterniond((R_parent.transpose() * body.R_PJ * R).transpose()));
    const btVector3 axis = toBullet(Vector3d(R.transpose() * body.axis));
    const btVector3 com_to_pivot = toBullet(Vector3d(R_parent.transpose() * (body.p_PJ - com_parent)));
    const btVector3 pivot_to_com = toBullet(Vector3d(R.transpose() * body.com_m));
    if (body.prismatic) {
      bullet_->setupPrismatic(i, body.mass_kg, toBullet(moments), body.parent, parent_to_this, axis, com_to_pivot,
                              pivot_to_com, true);
    } else {
      bullet_->setupRevolute(i, body.mass_kg, toBullet(moments), body.parent, parent_to_this, axis, com_to_pivot,
                             pivot_to_com, true);
    }
  }
  bullet_->finalizeMultiDof();
  bullet_->setLinearDamping(0.0);
  bullet_->setAngularDamping(0.0);
  bullet_->setMaxCoordinateVelocity(std::numeric_limits<double>::max());  // no hidden clamp
  bullet_->setCanSleep(false);
  bullet_->clearForcesAndTorques();
  for (int i = 0; i < n; ++i) bullet_->addLinkForce(i, toBullet(gravity_m_s2_) * bodies_[i].mass_kg);
  if (base_) bullet_->addBaseForce(toBullet(gravity_m_s2_) * base_body_.mass_kg);
  bullet_in_.assign(6 + n, 0.0);
  bullet_out_.assign(6 + n, 0.0);
}

void ArticulatedBody::placeBullet() {
  bullet_->setBaseWorldTransform(
      btTransform(toBullet(Quaterniond(base_->R() * R_base_principal_)), toBullet(base_->com())));
}

void ArticulatedBody::freeVelocities(const Eigen::VectorXd& v, double dt_s, Eigen::VectorXd& v_free) {
  const int n = dofs();
  for (int i = 0; i < n; ++i) bullet_->setJointVel(i, v[bodies_[i].index]);
  if (base_) {
    bullet_->setBaseVel(toBullet(Vector3d(base_->velocity().head<3>())));
    bullet_->setBaseOmega(toBullet(Vector3d(base_->velocity().tail<3>())));
  }
  bullet_->computeAccelerationsArticulatedBodyAlgorithmMultiDof(dt_s, scratch_r_, scratch_v_, scratch_m_, false, false,
                                                                false);
  for (int i = 0; i < n; ++i) v_free[bodies_[i].index] = bullet_->getJointVel(i);
  if (!base_) return;
  const btVector3 linear = bullet_->getBaseVel();
  const btVector3 angular = bullet_->getBaseOmega();
  Twist free;
  free << linear.x(), linear.y(), linear.z(), angular.x(), angular.y(), angular.z();
  base_->setFreeVelocity(free);
}

void ArticulatedBody::accelerations(const Eigen::VectorXd& efforts, Eigen::VectorXd& a) {
  for (int i = 0; i < dofs(); ++i) bullet_in_[6 + i] = efforts[bodies_[i].index];
  bullet_->calcAccelerationDeltasMultiDof(bullet_in_.data(), bullet_out_.data(), scratch_r_, scratch_v_);
  a.resize(dofs());
  for (int i = 0; i < dofs(); ++i) a[bodies_[i].index] = bullet_out_[6 + i];
}

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
