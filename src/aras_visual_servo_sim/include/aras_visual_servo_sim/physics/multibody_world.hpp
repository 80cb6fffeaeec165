#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "aras_visual_servo_sim/config/types.hpp"
#include "aras_visual_servo_sim/physics/managed/controller_set.hpp"
#include "aras_visual_servo_sim/physics/world_config.hpp"
#include "aras_visual_servo_sim/robot/robot_model.hpp"

namespace aras_visual_servo_sim {

class ArticulatedBody;
class DrivenBase;
class JointCoupling;
class JointDrive;
class JointGraph;
class JointSolver;
class WorldContacts;

/** Commands by joint name; a joint may be absent from any map. */
struct JointCommand {
  std::map<std::string, double> position;  ///< set-point [m or rad]
  std::map<std::string, double> velocity;  ///< [m/s or rad/s]; position controllers integrate it into their set-point
  std::map<std::string, double> effort;    ///< [N or N m]

  bool empty() const { return position.empty() && velocity.empty() && effort.empty(); }
};

/** Force at a point of contact. */
struct ContactForce {
  /** Links, solids, `ground_plane`, or links of other robots as ROBOT::LINK. */
  std::string a, b;
  Eigen::Vector3d point_W;   ///< [m]
  Eigen::Vector3d normal_W;  ///< from b to a
  double depth_m = 0.0;
  Eigen::Vector3d force_W;  ///< on a [N]
};

/** The robot as an articulated body under gravity, its joint controllers, friction and limits.
 *
 *  The root link is fixed in the world W, by default with its frame in W's, or a free body; then a base takes no effort
 *  and has a pose and a twist beside the joints. Joints that mimic others have entries in the joint vectors and nothing
 *  to be commanded. One step takes the state at t to t + period_s:
 *  velocities first, then positions with the new velocities (semi-implicit Euler, first order).
 *  Vectors of joints are in the order of jointNames(), shape (n,). Of a driven base they hold its pose and twist, see
 *  jointNames(model, config); it takes positions and velocities and is where they put it. */
class MultibodyWorld {
 public:
  /** State: q = 0 (clamped to the limits), at rest. @throws ParameterError if the configuration is out of range. */
  MultibodyWorld(const RobotModel& model, const WorldConfig& config);
  ~MultibodyWorld();
  MultibodyWorld(const MultibodyWorld&) = delete;
  MultibodyWorld& operator=(const MultibodyWorld&) = delete;

  const RobotModel& model() const { return model_; }
  /** Of the joint vectors. */
  const std::vector<std::string>& jointNames() const;
  const WorldConfig& config() const { return config_; }

  /** Back to tick 0: given positions, at rest, set-points there, controllers without memory, gains as configured, the
   *  base where it began. Entries of mimic joints follow from the others.
   *  @throws ShapeError, NotFiniteError, ParameterError (outside the position limits); nothing changes then. */
  void reset(const Eigen::VectorXd& q);

  /** Puts the named joints at rest at these positions, set-points too; the others keep position and velocity, and the
   *  clock goes on. A mimic joint may be named only with the position that the joint it follows gives it.
   *  @throws UnknownNameError, NotFiniteError, ParameterError; nothing changes then. */
  void setJointPositions(const std::map<std::string, double>& positions);

  /** As reset(q) for velocities, positions untouched; for experiments and tests. Mimic joints' entries follow. */
  void setJointVelocities(const Eigen::VectorXd& v);

  /** Whether other robots can be welded to this one, see Weld: its base is driven, or its contacts have neighbours. */
  bool takesWelds() const { return drivenBase() || contacts_; }

  /** The points of contact of the last step, with their forces. */
  std::vector<ContactForce> contacts() const;

  /** Steps since the last reset whose contact impulses did not settle within the bound on the work of a step. */
  std::uint64_t unsettledSteps() const { return unsettled_steps_; }
  /** Pose of an obstacle of the contacts. @throws UnknownNameError */
  Pose obstaclePose(const std::string& obstacle) const;
  /** Its twist [v; w] in world axes, of its frame; zero for one without mass. @throws UnknownNameError */
  Twist obstacleTwist(const std::string& obstacle) const;
  /** Sets which bodies touch each other from now on. Obstacles that were there before keep their pose and velocity.
   *  @throws ParameterError, ModelError; nothing changes then. */
  void setContacts(const ContactConfig& config);
  /** Takes over poses and velocities of those obstacles that another world has too, by name. */
  void takeObstacles(MultibodyWorld& other);
  /** Places an obstacle, at rest. @throws UnknownNameError, NotFiniteError */
  void setObstaclePose(const std::string& obstacle, const Pose& X_WO);

  /** True of a driven base too. */
  bool floatingBase() const;
  bool drivenBase() const { return driven_ != nullptr; }
  /** X_WB of the root link, or of the child of a floating joint. */
  Pose basePose() const;
  /** Places a floating base, at rest; the joints keep their positions and velocities.
   *  @throws ParameterError if the base is fixed, NotFiniteError */
  void setBasePose(const Pose& X_WB);
  /** Twist of a floating base, not a driven one, [v; w] of its frame's origin in world axes. @throws as setBasePose */
  void setBaseTwist(const Twist& V_WB_W);

  /** n periods. */
  void step(int n = 1);

  std::int64_t ticks() const { return ticks_; }
  /** Lets this be the present tick, of a world that has not stepped yet. */
  void beginAt(std::int64_t tick) { ticks_ = tick; }

  const Eigen::VectorXd& jointPositions() const { return q_; }
  const Eigen::VectorXd& jointVelocities() const { return v_; }
  /** Efforts that the actuators really applied in the last step, after all limits [N or N m]. */
  const Eigen::VectorXd& jointEfforts() const { return effort_; }

  /** @throws UnknownNameError, NotFiniteError, ParameterError (joint takes no such command); nothing changes then. */
  void setCommand(const JointCommand& command) { takeCommand(command, true); }
  void setPosition(const std::string& joint, double set_point) { setCommand({{{joint, set_point}}, {}, {}}); }
  void setVelocity(const std::string& joint, double velocity) { setCommand({{}, {{joint, velocity}}, {}}); }
  void setEffort(const std::string& joint, double effort) { setCommand({{}, {}, {{joint, effort}}}); }
  /** The command that moves a driven base with the twist V_WL_L, [v; w], of a link that it carries; "": of itself.
   *  @throws ParameterError if the base is not driven or does not carry the link, UnknownNameError */
  JointCommand twistCommand(const Twist& V_WL_L, const std::string& link) const;
  /** Every commanded velocity becomes 0. */
  void hold();

  /** As a Float64 on the controller's command topic: position, velocity or effort as its type has it; no timeout. */
  void setControllerCommand(const std::string& controller, double value);

  std::vector<std::string> controllerNames() const;
  const ControllerConfig& controllerConfig(const std::string& controller) const;
  ControllerState controllerState(const std::string& controller) const;
  /** Changes gains while running; the integral is kept. @throws UnknownNameError, ParameterError */
  void setGains(const std::string& controller, const PidGains& gains);

  // --- controllers as ros_control's controller manager has them: loaded, started and stopped between two steps
  /** @return what was ignored, a line each @throws as ControllerSet::load */
  std::vector<std::string> loadController(const std::string& name, const YAML::Node& parameters) {
    return controllers_.load(name, parameters, model_);
  }
  /** @throws as ControllerSet::unload */
  void unloadController(const std::string& name) { controllers_.unload(name); }
  /** @throws as ControllerSet::plan, ParameterError: a joint it cannot drive; nothing changes then */
  void switchControllers(const std::vector<std::string>& start, const std::vector<std::string>& stop, bool strict);
  const ControllerSet& controllers() const { return controllers_; }
  /** Gives the controllers of another world of this model, to go on here from where the joints are. */
  void takeControllers(MultibodyWorld& other);
  /** A running controller, to be told what to do. @throws UnknownNameError, ParameterError: it does not run */
  Controller& runningController(const std::string& name);
  /** State of the joints of a controller. */
  std::vector<JointNow> jointsOf(const Controller& controller) const;
  /** Sets all joints of a running group at once, in the order of its joints.
   *  @throws UnknownNameError, ParameterError (does not run, wrong size), NotFiniteError; nothing changes then */
  void setGroupCommand(const std::string& controller, const std::vector<double>& values);

  /** X_WL of any link, fixed ones included. */
  Pose linkPose(int link) const;
  Pose linkPose(const std::string& link) const { return linkPose(model_.linkIndex(link)); }
  /** V_WL_L: twist of L in W, expressed in L, [v; w]. */
  Twist linkTwist(int link) const;
  Twist linkTwist(const std::string& link) const { return linkTwist(model_.linkIndex(link)); }

  // --- forces from outside, and what sensors measure, world_forces.cpp
  /** Forces at the centres of mass of links from now on, in world axes [f; tau], and on joints, besides those of their
   *  actuators [N or N m]; by name, in the place of all there were. A reset ends them.
   *  @throws UnknownNameError, NotFiniteError; nothing changes then */
  void push(const std::map<std::string, Twist>& links, const std::map<std::string, double>& joints);
  /** [a; dw/dt] of a link's origin and axes in the last step, in the axes of the link; gravity is no part of it. */
  Twist linkAcceleration(const std::string& link) const;
  /** What the child link of a joint, fixed ones too, exerted on its parent in the last step: [f; tau about the child's
   *  origin] in the child's axes. @throws UnknownNameError */
  Twist jointWrench(const std::string& joint) const;

  /** Inertia matrix the joints see before mimic joints are taken out, a free base following, (n, n). */
  Eigen::MatrixXd massMatrix() const;
  /** Kinetic plus potential energy (zero where every centre of mass is at the world origin) [J]. */
  double energy() const;

  /** The whole state as bytes, gains included: a world that gets it back goes on exactly as this one does. */
  std::string saveState() const;
  /** @throws StateError if the bytes do not come from a world of this model and these controllers. */
  void restoreState(const std::string& state);

 private:
  friend class TouchingRobots;

  /** A running controller that moves its set-points. */
  struct Acting {
    Controller* controller;
    std::vector<int> joints;
    std::vector<JointNow> now;
    std::vector<JointTarget> targets;
  };

  void checkDriven() const;
  void makeDrives();
  void start();
  void advance();
  // --- the parts of a step, of a base that is not driven
  /** How everything would move freely, and where it touches. */
  void beginStep();
  /** The velocities after the step, of this world alone. */
  void solveStep();
  void finishStep();
  void checkVelocities() const;
  /** Inertia and free velocities of the coordinates. */
  const std::vector<double>& massUsed() const;
  const Eigen::VectorXd& freeUsed() const;
  double timeS() const { return static_cast<double>(ticks_) * config_.period_s; }

  Pose initialBasePose() const;
  /** At rest; the joints stay. */
  void placeBase(const Pose& X_WB);
  void checkBase(const std::string& what, bool finite) const;
  /** The body, q and v follow the driven base. */
  void followDriven();
  /** Checked coordinates of the driven base by index. @throws UnknownNameError, NotFiniteError */
  std::map<int, double> drivenValues(const std::map<std::string, double>& values, const char* kind) const;
  /** Index of an obstacle of the contacts. @throws UnknownNameError */
  std::size_t obstacleIndex(const std::string& name) const;
  /** A mimic joint that is named must be where what it follows puts it. */
  void checkFollower(int joint, const Eigen::VectorXd& wanted) const;
  void checkPosition(int joint, double position) const;

  // --- world_commands.cpp
  /** One checked command: everything is looked up before anything is done.
   *  @param expires  whether its velocities do so after config.command_timeout_s; else, as efforts, after the time of
   *                  their controller */
  void takeCommand(const JointCommand& command, bool expires);
  void commandDriven(const JointCommand& command, bool expires);
  void takeValues(const std::vector<const JointDrive*>& drives, const std::vector<double>& values);
  void checkCommand(const std::map<std::string, double>& values, bool (JointDrive::*takes)() const,
                    const char* kind) const;
  std::int64_t expiryTick(double timeout_s) const;
  /** @throws UnknownNameError, ParameterError naming what a mimic joint follows */
  const JointDrive& driveOfJoint(const std::string& name) const;
  JointDrive& driveOfJoint(const std::string& name);
  const JointDrive& driveOf(int joint) const;
  const JointDrive& driveOf(const std::string& controller) const;

  Controller* findRunning(const std::string& name) const;

  // --- world_controllers.cpp
  void idle(JointDrive& drive, double q);
  void idle(const Controller& controller);
  void engage(const Controller& controller);
  void listActing();
  void letControllersAct();
  /** These in place of those there were; the running ones go on, their drives have to be restored. */
  void adopt(ControllerSet next);
  /** The running controllers begin anew from where the joints are. */
  void restartControllers();

  // --- world_forces.cpp
  Eigen::VectorXd acceleration() const { return (v_ - v_before_) / config_.period_s; }
  Twist baseAcceleration() const;
  /** Lets what pushes from outside act in the step to come, where the body is now. */
  void letOutsidePush();
  /** Centre of mass of a link in the world. */
  Eigen::Vector3d pushedPoint(int link) const;
  /** Nothing pushes. */
  void endPushes();

  // --- world_state.cpp
  void visitState(Archive& archive);
  /** What a saved state must match: the joints, their controllers, the base and the period. */
  std::string signature() const;

  const RobotModel model_;
  const WorldConfig config_;
  const std::unique_ptr<JointCoupling> coupling_;
  const std::unique_ptr<ArticulatedBody> body_;
  std::unique_ptr<DrivenBase> driven_;  // null: forces move the robot
  const std::unique_ptr<JointSolver> solver_;
  std::unique_ptr<WorldContacts> contacts_;  // null: nothing touches
  std::vector<JointDrive> drives_;           // of the coordinates
  ControllerSet controllers_;
  std::vector<Acting> acting_;
  std::vector<JointGraph> graphs_;
  std::vector<double> M_, M_c_;                // of the joints, of the coordinates
  Eigen::VectorXd q_, v_, v_free_, effort_;    // of the joints
  Eigen::VectorXd v_before_;                   // v of the step before
  Twist base_before_ = Twist::Zero();          // of a free base, likewise
  std::map<int, Twist> link_pushes_;           // from outside, on links by index
  std::map<int, double> joint_pushes_;         // on joints
  Eigen::VectorXd v_next_, v_free_c_, total_;  // of the coordinates
  std::int64_t ticks_ = 0;
  std::uint64_t unsettled_steps_ = 0;
};

}  // namespace aras_visual_servo_sim
