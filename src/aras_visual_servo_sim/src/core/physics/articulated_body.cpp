#include "articulated_body.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <limits>

#include "aras_visual_servo_sim/errors.hpp"

namespace aras_visual_servo_sim {

using Eigen::Matrix3d;
using Eigen::Vector3d;

namespace {

btVector3 toBullet(const Vector3d& v) { return btVector3(v.x(), v.y(), v.z()); }

btQuaternion toBullet(const Matrix3d& R) {
  const Eigen::Quaterniond q(R);
  return btQuaternion(q.x(), q.y(), q.z(), q.w());
}

/** Inertia of a point mass about the origin: m (|p|^2 1 - p p^T). */
Matrix3d pointInertia(double mass_kg, const Vector3d& p) {
  return mass_kg * (p.squaredNorm() * Matrix3d::Identity() - p * p.transpose());
}

/** Rotation about a unit axis (Rodrigues). */
Matrix3d rotationAbout(const Vector3d& axis, double angle_rad) {
  return Eigen::AngleAxisd(angle_rad, axis).toRotationMatrix();
}

/** Right-handed principal axes of an inertia tensor, moments in `moments`. */
Matrix3d principalAxes(const Matrix3d& inertia, Vector3d& moments) {
  const Eigen::SelfAdjointEigenSolver<Matrix3d> solver(inertia);
  moments = solver.eigenvalues();
  Matrix3d R = solver.eigenvectors();
  if (R.determinant() < 0.0) R.col(2) = -R.col(2);
  return R;
}

}  // namespace

ArticulatedBody::ArticulatedBody(const RobotModel& model, const Vector3d& gravity_m_s2) : gravity_m_s2_(gravity_m_s2) {
  addBodies(model);
  frames_.resize(bodies_.size());
  composites_.resize(bodies_.size());
  buildBullet(gravity_m_s2);
  checkInertia(model);
}

void ArticulatedBody::addBodies(const RobotModel& model) {
  for (const Link& link : model.links) {
    int body = -1;
    Pose X_body_link;
    if (link.parent_joint >= 0) {
      const Joint& joint = model.joints[link.parent_joint];
      const Pose X_PJ = X_body_link_[joint.parent_link] * joint.X_PJ;
      body = link_body_[joint.parent_link];
      X_body_link = X_PJ;
      if (joint.moves()) {
        Body moving;
        moving.parent = body;
        moving.index = joint.index;
        moving.prismatic = joint.type == JointType::kPrismatic;
        moving.p_PJ = X_PJ.p;
        moving.R_PJ = X_PJ.q.toRotationMatrix();
        moving.axis = joint.axis;
        body = static_cast<int>(bodies_.size());
        bodies_.push_back(moving);
        X_body_link = Pose{};
      }
    }
    if (body >= 0) mergeInertia(link, bodies_[body], X_body_link);
    link_body_.push_back(body);
    X_body_link_.push_back(X_body_link);
  }
}

void ArticulatedBody::mergeInertia(const Link& link, Body& body, const Pose& X_body_link) {
  if (link.mass_kg == 0.0) return;
  const Matrix3d R = X_body_link.q.toRotationMatrix();
  const Vector3d com = X_body_link * link.com_m;
  const double mass = body.mass_kg + link.mass_kg;
  const Vector3d merged_com = (body.mass_kg * body.com_m + link.mass_kg * com) / mass;
  body.inertia_kg_m2 += pointInertia(body.mass_kg, body.com_m - merged_com) + R * link.inertia_kg_m2 * R.transpose() +
                        pointInertia(link.mass_kg, com - merged_com);
  body.mass_kg = mass;
  body.com_m = merged_com;
}

void ArticulatedBody::buildBullet(const Vector3d& gravity_m_s2) {
  const int n = dofs();
  bullet_ = std::make_unique<btMultiBody>(n, 1.0, btVector3(1, 1, 1), true, false);
  bullet_->setBaseWorldTransform(btTransform::getIdentity());
  std::vector<Matrix3d> R_principal(n);
  for (int i = 0; i < n; ++i) {
    const Body& body = bodies_[i];
    Vector3d moments = Vector3d::Zero();
    R_principal[i] = body.mass_kg > 0.0 ? principalAxes(body.inertia_kg_m2, moments) : Matrix3d::Identity();
    const Matrix3d& R = R_principal[i];
    const Matrix3d R_parent = body.parent < 0 ? Matrix3d(Matrix3d::Identity()) : R_principal[body.parent];
    const Vector3d com_parent = body.parent < 0 ? Vector3d(Vector3d::Zero()) : bodies_[body.parent].com_m;
    const btQuaternion parent_to_this = toBullet(Matrix3d((R_parent.transpose() * body.R_PJ * R).transpose()));
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
  for (int i = 0; i < n; ++i) bullet_->addLinkForce(i, toBullet(gravity_m_s2) * bodies_[i].mass_kg);
  bullet_in_.assign(6 + n, 0.0);
  bullet_out_.assign(6 + n, 0.0);
}

void ArticulatedBody::checkInertia(const RobotModel& model) {
  const int n = dofs();
  setPositions(Eigen::VectorXd::Zero(n));
  std::vector<double> M;
  massMatrix(M);
  for (int i = 0; i < n; ++i) {
    if (M[i * n + i] > 0.0) continue;
    throw ModelError(model.source_name + ": joint '" + model.joint_names[i] +
                     "': inertia it moves is 0, must be > 0 (<inertial> of its child link or of links fixed to it)");
  }
}

void ArticulatedBody::setPositions(const Eigen::VectorXd& q) {
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    const Body& body = bodies_[i];
    Frame& frame = frames_[i];
    const double position = q[body.index];
    if (body.parent < 0) {
      frame.R = body.R_PJ;
      frame.p = body.p_PJ;
    } else {
      const Frame& parent = frames_[body.parent];
      frame.R.noalias() = parent.R * body.R_PJ;
      frame.p.noalias() = parent.p + parent.R * body.p_PJ;
    }
    frame.axis.noalias() = frame.R * body.axis;
    if (body.prismatic) {
      frame.p += position * frame.axis;
    } else {
      frame.R = frame.R * rotationAbout(body.axis, position);
    }
    frame.com.noalias() = frame.p + frame.R * body.com_m;
    bullet_->setJointPos(static_cast<int>(i), position);
  }
}

void ArticulatedBody::freeVelocities(const Eigen::VectorXd& v, double dt_s, Eigen::VectorXd& v_free) {
  const int n = dofs();
  for (int i = 0; i < n; ++i) bullet_->setJointVel(i, v[bodies_[i].index]);
  bullet_->computeAccelerationsArticulatedBodyAlgorithmMultiDof(dt_s, scratch_r_, scratch_v_, scratch_m_, false, false,
                                                                false);
  for (int i = 0; i < n; ++i) v_free[bodies_[i].index] = bullet_->getJointVel(i);
}

void ArticulatedBody::accelerations(const Eigen::VectorXd& efforts, Eigen::VectorXd& a) {
  for (int i = 0; i < dofs(); ++i) bullet_in_[6 + i] = efforts[bodies_[i].index];
  bullet_->calcAccelerationDeltasMultiDof(bullet_in_.data(), bullet_out_.data(), scratch_r_, scratch_v_);
  a.resize(dofs());
  for (int i = 0; i < dofs(); ++i) a[bodies_[i].index] = bullet_out_[6 + i];
}

void ArticulatedBody::massMatrix(std::vector<double>& M) const {
  const int n = dofs();
  M.resize(static_cast<std::size_t>(n) * n);
  std::fill(M.begin(), M.end(), 0.0);
  for (int i = 0; i < n; ++i) {
    const Body& body = bodies_[i];
    Composite& composite = composites_[i];
    const Frame& frame = frames_[i];
    composite.mass = body.mass_kg;
    composite.first = body.mass_kg * frame.com;
    composite.second.noalias() = frame.R * body.inertia_kg_m2 * frame.R.transpose();
    composite.second += pointInertia(body.mass_kg, frame.com);
  }
  for (int i = n - 1; i >= 0; --i) {
    const Body& body = bodies_[i];
    const Composite& composite = composites_[i];
    const Frame& frame = frames_[i];
    // Momentum of the composite when joint i alone moves at unit rate: P linear, L about the world origin.
    Vector3d P, L;
    if (body.prismatic) {
      P = composite.mass * frame.axis;
      L = composite.first.cross(frame.axis);
    } else {
      const Vector3d v0 = frame.p.cross(frame.axis);
      P = composite.mass * v0 + frame.axis.cross(composite.first);
      L = composite.second * frame.axis + composite.first.cross(v0);
    }
    for (int j = i; j >= 0; j = bodies_[j].parent) {
      const Frame& at = frames_[j];
      const double m = bodies_[j].prismatic ? at.axis.dot(P) : at.axis.dot(L - at.p.cross(P));
      M[body.index * n + bodies_[j].index] = m;
      M[bodies_[j].index * n + body.index] = m;
    }
    if (body.parent >= 0) {
      Composite& parent = composites_[body.parent];
      parent.mass += composite.mass;
      parent.first += composite.first;
      parent.second += composite.second;
    }
  }
}

Pose ArticulatedBody::linkPose(int link) const {
  const int body = link_body_[link];
  if (body < 0) return X_body_link_[link];
  const Frame& frame = frames_[body];
  return Pose{frame.p, Eigen::Quaterniond(frame.R)} * X_body_link_[link];
}

Twist ArticulatedBody::linkTwist(int link, const Eigen::VectorXd& v) const {
  const Pose X_WL = linkPose(link);
  Vector3d linear = Vector3d::Zero();
  Vector3d angular = Vector3d::Zero();
  for (int body = link_body_[link]; body >= 0; body = bodies_[body].parent) {
    const Frame& frame = frames_[body];
    const double rate = v[bodies_[body].index];
    if (bodies_[body].prismatic) {
      linear += rate * frame.axis;
    } else {
      angular += rate * frame.axis;
      linear += rate * frame.axis.cross(X_WL.p - frame.p);
    }
  }
  Twist V_WL_L;
  V_WL_L << X_WL.q.conjugate() * linear, X_WL.q.conjugate() * angular;
  return V_WL_L;
}

double ArticulatedBody::potentialEnergy() const {
  double energy = 0.0;
  for (std::size_t i = 0; i < bodies_.size(); ++i) energy -= bodies_[i].mass_kg * gravity_m_s2_.dot(frames_[i].com);
  return energy;
}

}  // namespace aras_visual_servo_sim
