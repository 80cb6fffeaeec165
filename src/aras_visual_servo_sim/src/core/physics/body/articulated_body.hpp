#pragma once

#include <BulletDynamics/Featherstone/btMultiBody.h>

#include <Eigen/Core>
#include <map>
#include <memory>
#include <vector>

#include "aras_visual_servo_sim/config/types.hpp"
#include "aras_visual_servo_sim/robot/robot_model.hpp"
#include "floating_base.hpp"
#include "physics/drive/joint_coupling.hpp"

namespace aras_visual_servo_sim {

/** The tree of moving bodies of a robot: fixed links merged into what carries them, motion without any joint effort
 * from Bullet's articulated-body algorithm, inertia matrix from the composite bodies. Vectors of joints: joint_names
 * order. */
class ArticulatedBody {
 public:
  /** @param floating  whether the root link, or the child of the floating joint, is free
   *  @param driven    it is free, but no force moves it: it needs no inertia
   *  @param X_WB      where that body is placed; it stays there if not free
   *  @throws ModelError naming a joint that moves no inertia, or a free base without any. */
  ArticulatedBody(const RobotModel& model, const Eigen::Vector3d& gravity_m_s2, bool floating, const Pose& X_WB,
                  bool driven = false);

  int dofs() const { return static_cast<int>(bodies_.size()); }

  /** Frames of all bodies at q; everything below refers to the last q given here. */
  void setPositions(const Eigen::VectorXd& q);

  /** Velocities dt_s later under gravity and the velocity-dependent forces alone, from velocities v. */
  void freeVelocities(const Eigen::VectorXd& v, double dt_s, Eigen::VectorXd& v_free);

  /** Forces from outside in the steps to come: on links in world axes [f; tau about the link's origin], and on joints.
   *  To be called again whenever the body has moved. */
  void push(const std::map<int, Twist>& links, const std::map<int, double>& joints);

  /** Inertia matrix the joints see, a free base following: row-major (n, n), both triangles. */
  void massMatrix(std::vector<double>& M) const;

  /** Accelerations that joint efforts alone would cause, by Bullet; valid after freeVelocities(). */
  void accelerations(const Eigen::VectorXd& efforts, Eigen::VectorXd& a);

  /** The free base, or null. Its pose enters with the next setPositions(). */
  FloatingBase* base() { return base_.get(); }
  const FloatingBase* base() const { return base_.get(); }

  Pose linkPose(int link) const;
  Twist linkTwist(int link, const Eigen::VectorXd& v) const;
  /** Acceleration of a link's origin and of its axes, [a; dw/dt] in world axes.
   *  @param v, a  velocities and accelerations of the joints  @param base_a  of a free base, as its velocity() */
  Twist linkAcceleration(int link, const Eigen::VectorXd& v, const Eigen::VectorXd& a, const Twist& base_a) const;
  /** Whether no force moves the base. */
  bool driven() const { return driven_; }
  /** Whether a link can move at all. */
  bool moves(int link) const { return link_body_[link] >= 0 || (base_ && link_body_[link] != kOnWorld); }
  /** Whether two links are carried by one body, or by two with one joint between them. */
  bool adjacent(int one, int other) const;
  /** Adds the velocities along three axes (rows) at a point of a link, over the coordinates; with a free base those it
   *  has by the joints, the base following them. */
  void addPointRows(int link, const Eigen::Vector3d& p_W, const Eigen::Matrix3d& axes, const JointCoupling& coupling,
                    Eigen::Ref<Eigen::Matrix<double, 3, Eigen::Dynamic>, 0, Eigen::OuterStride<>> rows) const;
  double potentialEnergy() const;
  /** Of joint velocities v and of the base; after massMatrix(M). */
  double kineticEnergy(const std::vector<double>& M, const Eigen::VectorXd& v) const;

 private:
  static constexpr int kOnBase = -1;
  static constexpr int kOnWorld = -2;

  struct Body {
    int parent = -1;  // of bodies_, -1: the base or the world
    int index = 0;    // into joint_names
    bool prismatic = false;
    Eigen::Vector3d p_PJ, axis;
    Eigen::Matrix3d R_PJ;
    double mass_kg = 0.0;
    Eigen::Vector3d com_m = Eigen::Vector3d::Zero();
    Eigen::Matrix3d inertia_kg_m2 = Eigen::Matrix3d::Zero();
  };
  struct Frame {  // of a body in the world, and of its joint
    Eigen::Matrix3d R;
    Eigen::Vector3d p, axis, com;
  };
  struct Composite {  // inertia of a body and all it carries, about the world origin
    double mass;
    Eigen::Vector3d first;
    Eigen::Matrix3d second;
  };

  void addBodies(const RobotModel& model, const Pose& X_WB);
  void makeBase(const RobotModel& model, const Pose& X_WB);
  void placeBullet();
  void mergeInertia(const Link& link, Body& body, const Pose& X_body_link);
  void buildBullet();
  void checkInertia(const RobotModel& model);

  std::vector<Body> bodies_;  // parents first
  std::vector<Frame> frames_;
  mutable std::vector<Composite> composites_;
  std::vector<int> link_body_;  // kOnBase, kOnWorld, or of bodies_
  std::vector<Pose> X_body_link_;
  Eigen::Vector3d gravity_m_s2_;
  bool floating_, driven_;
  Body base_body_;  // inertia of the free base
  std::unique_ptr<FloatingBase> base_;
  Eigen::Matrix3d R_base_principal_ = Eigen::Matrix3d::Identity();

  std::unique_ptr<btMultiBody> bullet_;
  btAlignedObjectArray<btScalar> scratch_r_;
  btAlignedObjectArray<btVector3> scratch_v_;
  btAlignedObjectArray<btMatrix3x3> scratch_m_;
  std::vector<btScalar> bullet_in_, bullet_out_;
};

}  // namespace aras_visual_servo_sim
