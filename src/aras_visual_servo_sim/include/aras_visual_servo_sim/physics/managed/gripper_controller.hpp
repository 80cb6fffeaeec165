#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "aras_visual_servo_sim/physics/managed/controller.hpp"

namespace aras_visual_servo_sim {

/** A joint that closes until it reaches its goal or something stops it: ros_controllers' GripperActionController. */
class GripperController : public Controller {
 public:
  struct Settings {
    double goal_tolerance = 0.0, max_effort = 0.0, stall_speed = 0.0, stall_timeout_s = 0.0, monitor_rate_hz = 0.0;
  };
  enum class State { kNone, kActive, kReached, kStalled, kPreempted };

  GripperController(std::string name, std::string type, ControllerConfig drive, Settings settings);

  const Settings& settings() const { return settings_; }
  State state() const { return state_; }
  std::int64_t goals() const { return goals_; }    ///< pursued so far
  const JointNow& joint() const { return last_; }  ///< of the last update

  /** Closes to a position [m or rad] with an effort no larger than this [N or N m].
   *  @throws NotFiniteError; nothing changes then */
  void pursue(double position, double max_effort, double now_s);
  /** Ends the goal; the joint holds where it is. */
  void cancel(const JointNow& joint);

  void start(double time_s, const std::vector<JointNow>& joints) override;
  void stop() override;
  bool acts() const override { return true; }
  void update(double time_s, double dt_s, const std::vector<JointNow>& joints,
              std::vector<JointTarget>& targets) override;
  void visit(Archive& archive) override;

 private:
  void hold(const JointNow& joint);

  Settings settings_;
  State state_ = State::kNone;
  std::int64_t goals_ = 0;
  double position_ = 0.0, effort_ = 0.0, moved_s_ = 0.0;
  JointNow last_;
};

}  // namespace aras_visual_servo_sim
