#include "articulated_body.hpp"

#include <algorithm>

#include "aras_visual_servo_sim/config/errors.hpp"

namespace aras_visual_servo_sim {

using Eigen::Matrix3d;
using Eigen::Vector3d;

namespace {

/** Inertia of a point mass about the origin: m (|p|^2 1 - p p^T). */
Matrix3d pointInertia(double mass_kg, const Vector3d& p) {
  return mass_kg * (p.squaredNorm() * Matrix3d::Identity() - p * p.transpose());
}

/** Rotation about a unit axis (Rodrigues). */
Matrix3d rotationAbout(const Vector3d& axis, double angle_rad) {
  return Eigen::AngleAxisd(angle_rad, axis).toRotationMatrix();
}

}  // namespace

ArticulatedBody::ArticulatedBody(const RobotModel& model, const Vector3d& gravity_m_s2, bool floating, const Pose& X_WB,
                                 bool driven)
    : gravity_m_s2_(gravity_m_s2), floating_(floating), driven_(driven) {
  addBodies(model, X_WB);
  frames_.resize(bodies_.size());
  composites_.resize(bodies_.size());
  if (driven) {
    base_body_.mass_kg = 1.0;
    base_body_.inertia_kg_m2.setIdentity();
  }
  if (floating_) makeBase(model, X_WB);
  buildBullet();
  checkInertia(model);
}

void ArticulatedBody::addBodies(const RobotModel& model, const Pose& X_WB) {
  const Pose X_world_base = floating_ ? Pose{} : X_WB;  // a fixed base is a part of the world
  for (const Link& link : model.links) {
    int body = floating_ ? kOnBase : kOnWorld;
    Pose X_body_link = X_world_base;
    if (link.parent_joint < 0 && model.floatingJoint()) {
      body = kOnWorld;
      X_body_link = Pose{};
    } else if (link.parent_joint >= 0 && &model.joints[link.parent_joint] != model.floatingJoint()) {
      const Joint& joint = model.joints[link.parent_joint];
      const Pose X_PJ = X_body_link_[joint.parent_link] * joint.X_PJ;
      body = link_body_[joint.parent_link];
      X_body_link = X_PJ;
      if (joint.moves()) {
        Body moving;
        moving.parent = std::max(body, -1);
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
    if (body != kOnWorld) mergeInertia(link, body == kOnBase ? base_body_ : bodies_[body], X_body_link);
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

void ArticulatedBody::makeBase(const RobotModel& model, const Pose& X_WB) {
  if (!(base_body_.mass_kg > 0.0)) {
    const std::size_t link = model.floatingJoint() ? model.floatingJoint()->child_link : 0;
    throw ModelError(model.source_name + ": link '" + model.links[link].name +
                     "': is a floating base of mass 0, must have an <inertial> (or sim/base: fixed)");
  }
  base_ = std::make_unique<FloatingBase>(base_body_.mass_kg, base_body_.com_m, base_body_.inertia_kg_m2, dofs());
  base_->place(X_WB);
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
  if (base_) placeBullet();
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    const Body& body = bodies_[i];
    Frame& frame = frames_[i];
    const double position = q[body.index];
    if (body.parent < 0 && !base_) {
      frame.R = body.R_PJ;
      frame.p = body.p_PJ;
    } else if (body.parent < 0) {
      frame.R.noalias() = base_->R() * body.R_PJ;
      frame.p.noalias() = base_->p() + base_->R() * body.p_PJ;
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
  Composite rest{0.0, Vector3d::Zero(), Matrix3d::Zero()};  // all that a free base carries
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
    } else if (base_) {
      rest.mass += composite.mass;
      rest.first += composite.first;
      rest.second += composite.second;
    }
    if (base_) base_->setColumn(body.index, P, L);
  }
  if (base_) base_->eliminate(rest.mass, rest.first, rest.second, M);
}

Pose ArticulatedBody::linkPose(int link) const {
  const int body = link_body_[link];
  if (body == kOnWorld) return X_body_link_[link];
  if (body == kOnBase) return base_->pose() * X_body_link_[link];
  const Frame& frame = frames_[body];
  return Pose{frame.p, Eigen::Quaterniond(frame.R)} * X_body_link_[link];
}

Twist ArticulatedBody::linkTwist(int link, const Eigen::VectorXd& v) const {
  const Pose X_WL = linkPose(link);
  Vector3d linear = Vector3d::Zero();
  Vector3d angular = Vector3d::Zero();
  if (base_ && link_body_[link] != kOnWorld) {
    const Twist& v_base = base_->velocity();
    linear = v_base.head<3>() + v_base.tail<3>().cross(X_WL.p - base_->com());
    angular = v_base.tail<3>();
  }
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

bool ArticulatedBody::adjacent(int one, int other) const {
  const int a = std::max(link_body_[one], -1);
  const int b = std::max(link_body_[other], -1);
  return a == b || (a >= 0 && bodies_[a].parent == b) || (b >= 0 && bodies_[b].parent == a);
}

void ArticulatedBody::addPointRows(
    int link, const Vector3d& p_W, const Matrix3d& axes, const JointCoupling& coupling,
    Eigen::Ref<Eigen::Matrix<double, 3, Eigen::Dynamic>, 0, Eigen::OuterStride<>> rows) const {
  const auto add = [&](int joint, const Vector3d& velocity) {
    for (int k = 0; k < 3; ++k) coupling.add(joint, velocity[k], rows.row(k));
  };
  for (int body = link_body_[link]; body >= 0; body = bodies_[body].parent) {
    const Frame& frame = frames_[body];
    add(bodies_[body].index, axes * (bodies_[body].prismatic ? frame.axis : frame.axis.cross(p_W - frame.p)));
  }
  if (!base_) return;
  const Vector3d arm = p_W - base_->com();
  for (int joint = 0; joint < dofs(); ++joint) {
    const Twist response = base_->response().col(joint);
    add(joint, -(axes * (response.head<3>() + response.tail<3>().cross(arm))));
  }
}

double ArticulatedBody::potentialEnergy() const {
  double energy = 0.0;
  for (std::size_t i = 0; i < bodies_.size(); ++i) energy -= bodies_[i].mass_kg * gravity_m_s2_.dot(frames_[i].com);
  if (base_) energy -= base_->mass() * gravity_m_s2_.dot(base_->com());
  return energy;
}

double ArticulatedBody::kineticEnergy(const std::vector<double>& M, const Eigen::VectorXd& v) const {
  const double joints = 0.5 * v.dot(Eigen::Map<const Eigen::MatrixXd>(M.data(), dofs(), dofs()) * v);
  return base_ ? joints + base_->kineticEnergy(v) : joints;
}

}  // namespace aras_visual_servo_sim
