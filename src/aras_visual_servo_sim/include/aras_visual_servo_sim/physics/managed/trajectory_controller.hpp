#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "aras_visual_servo_sim/physics/managed/controller.hpp"
#include "aras_visual_servo_sim/physics/managed/trajectory.hpp"
#include "aras_visual_servo_sim/physics/pid.hpp"

namespace aras_visual_servo_sim {

/** How far a joint may be off; 0: as far as it likes. In a goal, 0: as the controller has it, negative: not at all. */
struct Tolerance {
  double position = 0.0, velocity = 0.0, acceleration = 0.0;

  /** Whether an error is within it. */
  bool holds(const TrajectoryState& error) const;
  /** This one with what a goal says of it. */
  Tolerance with(const Tolerance& goal) const;
};

/** What a goal asks for besides its trajectory, by joint. */
struct GoalTolerances {
  std::map<std::string, Tolerance> path, goal;
  double goal_time_s = 0.0;
};

enum class GoalState { kNone, kActive, kSucceeded, kPathViolated, kGoalViolated, kPreempted };

/** Joints that follow trajectories: ros_controllers' JointTrajectoryController, with its rules for what a new
 *  trajectory keeps of the old one, for tolerances, stopping and joints that are left out. */
class TrajectoryController : public Controller {
 public:
  struct Settings {
    std::vector<Tolerance> path, goal;  ///< by joint, in the order of the drives
    double goal_time_s = 0.0;
    double stop_duration_s = 0.0;  ///< how long it takes to stop; 0: it holds where it is
    double state_rate_hz = 0.0, monitor_rate_hz = 0.0;
    bool partial_joints = false;        ///< whether a trajectory may leave joints out
    std::vector<double> velocity_gain;  ///< velocity_ff: effort, or velocity, per desired velocity
    std::vector<bool> continuous;       ///< joints that turn without end
  };
  /** Where a joint should be at the present, is, and the difference, of the last update. */
  struct JointReport {
    TrajectoryState desired, actual, error;
  };

  TrajectoryController(std::string name, std::string type, std::vector<ControllerConfig> drives, Settings settings);

  const Settings& settings() const { return settings_; }
  std::vector<std::string> joints() const;

  /** Follows a trajectory from now on; one without points stops the joints. A goal that was active is preempted.
   *  @return what its author may want to know, "" if nothing
   *  @throws ParameterError: joints that are not its own, or missing, and as firstPointAfter(); nothing changes then */
  std::string follow(const Trajectory& trajectory, double now_s, const std::vector<JointNow>& joints);
  /** The same as a goal, which succeeds or is aborted. */
  std::string pursue(const Trajectory& trajectory, const GoalTolerances& tolerances, double now_s,
                     const std::vector<JointNow>& joints);
  /** Ends the goal, and stops. */
  void cancel(double now_s, const std::vector<JointNow>& joints);

  GoalState goalState() const { return goal_state_; }
  const std::string& goalError() const { return goal_error_; }  ///< why it was aborted
  std::int64_t goals() const { return goals_; }                 ///< pursued so far
  const std::vector<JointReport>& report() const { return report_; }
  /** Where the joints are to be at a time. */
  std::vector<TrajectoryState> at(double time_s) const;

  void start(double time_s, const std::vector<JointNow>& joints) override;
  void stop() override;
  bool acts() const override { return true; }
  void update(double time_s, double dt_s, const std::vector<JointNow>& joints,
              std::vector<JointTarget>& targets) override;
  void visit(Archive& archive) override;

 private:
  std::vector<int> places(const std::vector<std::string>& joints) const;
  std::string replace(const Trajectory& trajectory, bool is_goal, double now_s, const std::vector<JointNow>& joints);
  void standStill(double now_s, const std::vector<JointNow>& joints, bool is_goal);
  void judge(double time_s);
  void preempt();

  Settings settings_;
  std::vector<JointPath> paths_;
  std::vector<JointReport> report_;
  std::vector<Pid> pids_;  // of velocity joints
  GoalState goal_state_ = GoalState::kNone;
  std::string goal_error_;
  std::int64_t goals_ = 0;
  std::vector<Tolerance> path_tolerance_, goal_tolerance_;  // of the goal
  double goal_time_s_ = 0.0;
  std::vector<bool> arrived_;
};

}  // namespace aras_visual_servo_sim
