#pragma once

#include <cstdint>

#include "aras_visual_servo_sim/joint_controller.hpp"
#include "aras_visual_servo_sim/multibody_world.hpp"
#include "joint_graph.hpp"

namespace aras_visual_servo_sim {

/** What a joint's controller remembers; everything its future depends on. */
struct DriveMemory {
  double set_point = 0.0;         ///< position, velocity or effort, as the controller's type has it
  double velocity_command = 0.0;  ///< integrated into the set-point of a position controller
  std::int64_t command_tick = 0;  ///< of the last velocity command
  bool expires = false;           ///< whether that command does
  PidGains gains;
  PidState pid;
  double process_value = 0.0, process_value_dot = 0.0, error = 0.0, command = 0.0;
};

/** One joint with its controller, if it has one, friction, damping and limits. */
class JointDrive {
 public:
  JointDrive(const Joint& joint, const ControllerConfig* controller, Drive drive, double period_s,
             std::int64_t timeout_ticks);

  const Joint& joint() const { return joint_; }
  bool hasController() const { return has_controller_; }
  const ControllerConfig& controller() const { return controller_; }
  bool takesPosition() const;
  bool takesVelocity() const;
  bool takesEffort() const;

  DriveMemory& memory() { return memory_; }
  const DriveMemory& memory() const { return memory_; }

  /** ros_control's starting(): set-point where the joint is, no memory. Gains stay as they are. */
  void start(double q);

  /** Commands, each as the controller takes it; finite. */
  void commandPosition(double set_point);
  void commandVelocity(double velocity, std::int64_t tick, bool expires);
  void commandEffort(double effort);

  /** Moves the set-point on by one period and lays out the efforts possible in it, from the state at its beginning. */
  void prepare(double q, double v, std::int64_t tick, JointGraph& graph);

  /** Brings the controller's memory to the end of the period. */
  void finish(double q, double v, double v_before);

 private:
  bool positionControlled() const;
  bool hasPid() const;
  double positionError(double q) const;
  double velocityTarget(std::int64_t tick) const;
  void advanceSetPoint(std::int64_t tick);
  void evaluate(double error, double process_value, double process_value_dot);
  ActuatorLaw implicitPid(double error, double error_rate) const;
  ActuatorLaw law(double q, double v, std::int64_t tick);

  Joint joint_;
  ControllerConfig controller_;
  bool has_controller_;
  bool implicit_;
  double dt_s_;
  std::int64_t timeout_ticks_;
  DriveMemory memory_;
  double error_before_ = 0.0;  // of the position, at the beginning of the period
};

}  // namespace aras_visual_servo_sim
