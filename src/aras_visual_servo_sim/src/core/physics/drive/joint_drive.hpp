#pragma once

#include <cstdint>
#include <limits>

#include "aras_visual_servo_sim/physics/joint_controller.hpp"
#include "aras_visual_servo_sim/physics/managed/controller.hpp"
#include "aras_visual_servo_sim/robot/robot_model.hpp"
#include "joint_graph.hpp"

namespace aras_visual_servo_sim {

/** The tick that stands for "never". */
constexpr std::int64_t kNever = std::numeric_limits<std::int64_t>::max();

/** The memory of a joint's controller: everything on which its future output depends. */
struct DriveMemory {
  double set_point = 0.0;             ///< position, velocity or effort, as the controller's type has it
  double velocity_command = 0.0;      ///< integrated into the set-point of a position controller
  std::int64_t expiry_tick = kNever;  ///< at which the last velocity or effort command stops acting
  PidGains gains;
  PidState pid;
  double feed_forward = 0.0;                                        ///< effort added to that of a PID
  double effort_limit = std::numeric_limits<double>::infinity();    ///< of a PID, beside the joint's own
  double soft_position = std::numeric_limits<double>::quiet_NaN();  ///< last position command within soft limits
  double process_value = 0.0, process_value_dot = 0.0, error = 0.0, command = 0.0;
};

/** One joint with its controller, if it has one, friction, damping and limits. */
class JointDrive {
 public:
  /** @throws ParameterError for soft limits that lack the velocity or effort limits they need */
  JointDrive(const Joint& joint, const ControllerConfig* controller, Drive drive, double period_s);

  const Joint& joint() const { return joint_; }
  bool hasController() const { return has_controller_; }
  const ControllerConfig& controller() const { return controller_; }
  bool takesPosition() const;
  bool takesVelocity() const { return has_controller_ && controller_.type != ControllerType::kEffort; }
  bool takesEffort() const { return has_controller_ && controller_.type == ControllerType::kEffort; }

  DriveMemory& memory() { return memory_; }
  const DriveMemory& memory() const { return memory_; }

  /** Acts for this controller from now on. @throws as the constructor; nothing changes then */
  void engage(const ControllerConfig& controller, double q);
  /** Acts for none: the joint is passive. */
  void release();
  /** Whether a controller that drives the joint so could engage(). @throws as the constructor */
  void check(const ControllerConfig& controller) const;

  /** ros_control's starting(): set-point where the joint is, no memory. Gains stay as they are. */
  void start(double q);

  /** Commands, each as the controller takes it; finite. */
  void commandPosition(double set_point);
  void commandVelocity(double velocity, std::int64_t expiry_tick);
  void commandEffort(double effort, std::int64_t expiry_tick);

  /** What the controller wants at the end of the next period. */
  void aim(const JointTarget& target);

  /** Moves the set-point on by one period and makes the graph of efforts, from the state at the period's beginning. */
  void prepare(double q, double v, std::int64_t tick, JointGraph& graph);

  /** Brings the controller's memory to the end of the period. */
  void finish(double q, double v, double v_before);

 private:
  double positionError(double q) const;
  double velocityTarget(std::int64_t tick) const;
  void advanceSetPoint(std::int64_t tick);
  void evaluate(double error, double process_value, double process_value_dot);
  ActuatorLaw implicitPid(double error, double error_rate) const;
  ActuatorLaw law(double q, double v, std::int64_t tick);
  ActuatorLaw servoLaw(double q, double v, std::int64_t tick);
  void limitEffort(double q, double v, ActuatorLaw& law) const;

  Joint joint_;
  ControllerConfig controller_;
  bool has_controller_;
  bool implicit_;
  double dt_s_;
  DriveMemory memory_;
  double error_before_ = 0.0;  // of the position, at the beginning of the period
};

}  // namespace aras_visual_servo_sim
