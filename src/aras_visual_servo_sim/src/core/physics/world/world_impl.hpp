#pragma once

#include <map>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include "aras_visual_servo_sim/physics/managed/controller_set.hpp"
#include "aras_visual_servo_sim/physics/multibody_world.hpp"
#include "physics/body/articulated_body.hpp"
#include "physics/body/driven_base.hpp"
#include "physics/contact/world_contacts.hpp"
#include "physics/drive/joint_coupling.hpp"
#include "physics/drive/joint_drive.hpp"
#include "physics/drive/joint_solver.hpp"

namespace aras_visual_servo_sim {

/** The inside of a MultibodyWorld: its parts, and the order in which they act. */
class MultibodyWorld::Impl {
 public:
  Impl(const RobotModel& the_model, const WorldConfig& the_config);

  void start();
  void step();
  // --- the parts of a step, of a base that is not driven
  /** How everything would move freely, and where it touches. */
  void beginStep();
  /** The velocities after the step, of this world alone. */
  void solveStep();
  void finishStep();

  /** At rest; the joints stay. */
  void placeBase(const Pose& X_WB);
  /** The body, q and v follow the driven base. */
  void followDriven();
  /** Checked coordinates of the driven base by index. @throws UnknownNameError, NotFiniteError */
  std::map<int, double> drivenValues(const std::map<std::string, double>& values, const char* kind) const;
  Pose initialBasePose() const;

  /** One checked command: everything is looked up before anything is done.
   *  @param expires  whether its velocities do so after config.command_timeout_s; else, as efforts, after the time of
   *                  their controller */
  void command(const JointCommand& command, bool expires);

  /** @throws UnknownNameError, ParameterError naming what a mimic joint follows */
  const JointDrive& driveOfJoint(const std::string& name) const;
  JointDrive& driveOfJoint(const std::string& name);
  const JointDrive& driveOf(int joint) const { return drives[coupling.coordinate(joint)]; }
  JointDrive& driveOf(const std::string& controller);

  // --- controllers that are started and stopped, world_controllers.cpp
  void switchControllers(const std::vector<std::string>& start, const std::vector<std::string>& stop, bool strict);
  /** These in place of those there were; the running ones go on, their drives have to be restored. */
  void adopt(ControllerSet next);
  /** The running controllers begin anew from where the joints are. */
  void restartControllers();
  /** @throws UnknownNameError, ParameterError: it does not run */
  Controller& running(const std::string& name);
  std::vector<JointNow> jointsOf(const Controller& controller) const;
  /** Inertia and free velocities of the coordinates. */
  const std::vector<double>& massUsed() const { return coupling.any() ? M_c : M; }
  const Eigen::VectorXd& freeUsed() const { return coupling.any() ? v_free_c : v_free; }
  double timeS() const { return static_cast<double>(ticks) * config.period_s; }

  // --- world_forces.cpp
  Eigen::VectorXd acceleration() const { return (v - v_before) / config.period_s; }
  Twist baseAcceleration() const;
  /** Lets what pushes from outside act in the step to come, where the body is now. */
  void letOutsidePush();
  /** Centre of mass of a link in the world. */
  Eigen::Vector3d pushedPoint(int link) const;
  /** Nothing pushes. */
  void endPushes();
  void savePushes(MemoryWriter& out) const;

  /** Index of an obstacle of the contacts. @throws UnknownNameError */
  std::size_t obstacle(const std::string& name) const;
  void setContacts(const ContactConfig& config);
  void checkBase(const std::string& what, bool finite) const;
  /** A mimic joint that is named must be where what it follows puts it. */
  void checkFollower(int joint, const Eigen::VectorXd& wanted) const;
  void checkPosition(int joint, double position) const;

  /** Reads or writes the whole state; one function does both, so that the order is the same. */
  template <typename Stream>
  void visitState(Stream& stream);

  /** What a saved state must match: the joints, their controllers, the base and the period. */
  std::string signature() const;

  const RobotModel model;
  const WorldConfig config;
  JointCoupling coupling;
  ArticulatedBody body;
  std::unique_ptr<DrivenBase> driven;  // null: forces move the robot
  JointSolver solver;
  std::unique_ptr<WorldContacts> contacts;  // null: nothing touches
  std::vector<JointDrive> drives;           // of the coordinates
  ControllerSet controllers;
  std::vector<JointGraph> graphs;
  std::vector<double> M, M_c;               // of the joints, of the coordinates
  Eigen::VectorXd q, v, v_free, effort;     // of the joints
  Eigen::VectorXd v_before;                 // v of the step before
  Twist base_before = Twist::Zero();        // of a free base, likewise
  std::map<int, Twist> link_pushes;         // from outside, on links by index
  std::map<int, double> joint_pushes;       // on joints
  Eigen::VectorXd v_next, v_free_c, total;  // of the coordinates
  std::int64_t ticks = 0;
  std::uint64_t unsettled_steps = 0;

 private:
  /** A running controller that moves its set-points. */
  struct Acting {
    Controller* controller;
    std::vector<int> joints;
    std::vector<JointNow> now;
    std::vector<JointTarget> targets;
  };

  void letControllersAct();
  void listActing();
  void idle(JointDrive& drive, double q);
  std::vector<Acting> acting_;
  void makeDrives();
  void checkDriven() const;
  void commandDriven(const JointCommand& command, bool expires);
  std::int64_t expiryTick(double timeout_s) const;
  void checkVelocities() const;
  void checkCommand(const std::map<std::string, double>& values, bool (JointDrive::*takes)() const,
                    const char* kind) const;
};

/** A number as it stands in messages. */
inline std::string shown(double value) {
  std::ostringstream out;
  out << value;
  return out.str();
}

}  // namespace aras_visual_servo_sim
