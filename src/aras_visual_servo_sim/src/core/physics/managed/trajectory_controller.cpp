#include "aras_visual_servo_sim/physics/managed/trajectory_controller.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "aras_visual_servo_sim/config/archive.hpp"
#include "aras_visual_servo_sim/config/errors.hpp"
#include "aras_visual_servo_sim/config/section.hpp"

namespace aras_visual_servo_sim {
namespace {

constexpr double kTwoPi = 6.283185307179586476925;

double overruled(double own, double goal) { return goal > 0.0 ? goal : goal < 0.0 ? 0.0 : own; }

}  // namespace

bool Tolerance::holds(const TrajectoryState& error) const {
  const auto within = [](double tolerance, double value) { return !(tolerance > 0.0 && std::abs(value) > tolerance); };
  return within(position, error.position) && within(velocity, error.velocity) &&
         within(acceleration, error.acceleration);
}

Tolerance Tolerance::with(const Tolerance& goal) const {
  return {overruled(position, goal.position), overruled(velocity, goal.velocity),
          overruled(acceleration, goal.acceleration)};
}

TrajectoryController::TrajectoryController(std::string name, std::string type, std::vector<ControllerConfig> drives,
                                           Settings settings)
    : Controller(std::move(name), std::move(type), std::move(drives)), settings_(std::move(settings)) {
  report_.resize(this->drives().size());
  for (const ControllerConfig& drive : this->drives()) pids_.emplace_back(drive.gains);
}

std::vector<std::string> TrajectoryController::joints() const {
  std::vector<std::string> names;
  for (const ControllerConfig& drive : drives()) names.push_back(drive.joint);
  return names;
}

// --- what is followed -----------------------------------------------------------------------------------------------

/** Of each joint that is named, its place among our own. @throws ParameterError naming the joints there are */
std::vector<int> TrajectoryController::places(const std::vector<std::string>& named) const {
  const std::vector<std::string> own = joints();
  std::vector<int> places;
  bool fits = !named.empty() && (settings_.partial_joints ? named.size() <= own.size() : named.size() == own.size());
  for (const std::string& joint : named) {
    const auto at = std::find(own.begin(), own.end(), joint);
    const int place = static_cast<int>(at - own.begin());
    fits = fits && at != own.end() && std::count(places.begin(), places.end(), place) == 0;
    places.push_back(place);
  }
  if (fits) return places;
  throw ParameterError("Cannot create trajectory from message. It does not contain the expected joints: found " +
                       (named.empty() ? "none" : joined(named)) + ", allowed are " + joined(own) +
                       (settings_.partial_joints ? " or some of them" : ", all of them"));
}

/** Lets each joint rest: where it is, or at the end of a ramp from where it should be. */
void TrajectoryController::standStill(double now_s, const std::vector<JointNow>& joints, bool is_goal) {
  for (std::size_t i = 0; i < paths_.size(); ++i) {
    const TrajectoryState desired = paths_[i].at(now_s);
    JointPath rest = JointPath::resting(now_s, joints[i].position);
    if (settings_.stop_duration_s > 0.0) {
      rest.segments().front() = stopRamp(now_s, desired.position, desired.velocity, settings_.stop_duration_s);
    }
    rest.forGoal(is_goal);
    paths_[i] = std::move(rest);
  }
}

std::string TrajectoryController::replace(const Trajectory& trajectory, bool is_goal, double now_s,
                                          const std::vector<JointNow>& joints) {
  std::string note;
  if (trajectory.points.empty()) {
    standStill(now_s, joints, is_goal);
    return note;
  }
  const std::vector<int> own = places(trajectory.joints);
  const std::size_t first = firstPointAfter(trajectory, now_s, note);
  const double start_s = trajectory.start_s.value_or(now_s);
  const double takeover_s = std::max(start_s, now_s);
  const auto& points = trajectory.points;
  for (JointPath& path : paths_) path.forGoal(is_goal);  // of joints that are left out: they are part of the goal
  for (std::size_t j = 0; j < own.size(); ++j) {
    JointPath& path = paths_[own[j]];
    const TrajectoryState before = path.at(takeover_s);
    JointPath next = path.cut(now_s, takeover_s);
    next.forGoal(false);
    const double turns = settings_.continuous[own[j]] ? turnsBetween(before.position, points[first].positions[j]) : 0.0;
    Knot from{before.position, before.velocity, before.acceleration};
    double from_s = takeover_s;
    for (std::size_t k = first; k < points.size(); ++k) {
      Knot to{points[k].positions[j] + turns, std::nullopt, std::nullopt};
      if (!points[k].velocities.empty()) to.velocity = points[k].velocities[j];
      if (!points[k].accelerations.empty()) to.acceleration = points[k].accelerations[j];
      Segment segment(from_s, from, start_s + points[k].time_s, to);
      segment.of_goal = is_goal;
      next.add(segment);
      from = to;
      from_s = start_s + points[k].time_s;
    }
    path = std::move(next);
  }
  return note;
}

std::string TrajectoryController::follow(const Trajectory& trajectory, double now_s,
                                         const std::vector<JointNow>& joints) {
  const std::string note = replace(trajectory, false, now_s, joints);
  preempt();
  return note;
}

std::string TrajectoryController::pursue(const Trajectory& trajectory, const GoalTolerances& tolerances, double now_s,
                                         const std::vector<JointNow>& joints) {
  places(trajectory.joints);
  std::string note = replace(trajectory, true, now_s, joints);
  ++goals_;
  goal_state_ = GoalState::kActive;
  goal_error_.clear();
  path_tolerance_ = settings_.path;
  goal_tolerance_ = settings_.goal;
  const std::vector<std::string> own = this->joints();
  for (std::size_t i = 0; i < own.size(); ++i) {
    const auto path = tolerances.path.find(own[i]), goal = tolerances.goal.find(own[i]);
    if (path != tolerances.path.end()) path_tolerance_[i] = path_tolerance_[i].with(path->second);
    if (goal != tolerances.goal.end()) goal_tolerance_[i] = goal_tolerance_[i].with(goal->second);
  }
  goal_time_s_ = overruled(settings_.goal_time_s, tolerances.goal_time_s);
  arrived_.assign(own.size(), false);
  return note;
}

void TrajectoryController::preempt() {
  if (goal_state_ == GoalState::kActive) goal_state_ = GoalState::kPreempted;
}

void TrajectoryController::cancel(double now_s, const std::vector<JointNow>& joints) {
  if (goal_state_ != GoalState::kActive) return;
  preempt();
  standStill(now_s, joints, false);
}

std::vector<TrajectoryState> TrajectoryController::at(double time_s) const {
  std::vector<TrajectoryState> states;
  for (const JointPath& path : paths_) states.push_back(path.at(time_s));
  return states;
}

// --- running --------------------------------------------------------------------------------------------------------

void TrajectoryController::start(double time_s, const std::vector<JointNow>& joints) {
  preempt();
  paths_.clear();
  for (std::size_t i = 0; i < joints.size(); ++i) {
    paths_.push_back(JointPath::resting(time_s, joints[i].position));
    const TrajectoryState rest{joints[i].position, 0.0, 0.0};
    report_[i] = {rest, {joints[i].position, joints[i].velocity, 0.0}, {}};
    pids_[i].reset();
  }
}

void TrajectoryController::stop() { preempt(); }

void TrajectoryController::update(double time_s, double dt_s, const std::vector<JointNow>& joints,
                                  std::vector<JointTarget>& targets) {
  for (std::size_t i = 0; i < joints.size(); ++i) {
    JointReport& report = report_[i];
    report.desired = paths_[i].at(time_s);
    report.actual = {joints[i].position, joints[i].velocity, 0.0};
    const double error = report.desired.position - joints[i].position;
    report.error.position = settings_.continuous[i] ? std::remainder(error, kTwoPi) : error;
    report.error.velocity = report.desired.velocity - joints[i].velocity;
    const TrajectoryState next = paths_[i].at(time_s + dt_s);
    const double forward = settings_.velocity_gain[i] * next.velocity;
    if (drives()[i].type == ControllerType::kVelocity) {
      targets[i].set_point = forward + pids_[i].compute(report.error.position, report.error.velocity, dt_s);
    } else {
      targets[i] = {next.position, forward};
    }
  }
  if (goal_state_ == GoalState::kActive) judge(time_s);
}

/** Whether the goal has failed or succeeded by what was reported last. */
void TrajectoryController::judge(double time_s) {
  const auto fail = [this](GoalState state, std::size_t i, const char* what) {
    goal_state_ = state;
    goal_error_ = drives()[i].joint + what + std::to_string(report_[i].error.position);
  };
  for (std::size_t i = 0; i < paths_.size(); ++i) {
    const Segment& segment = paths_[i].active(time_s);
    if (!segment.of_goal) continue;
    if (time_s < segment.endS()) {
      if (!path_tolerance_[i].holds(report_[i].error)) return fail(GoalState::kPathViolated, i, " path error ");
    } else if (paths_[i].last(time_s)) {
      if (goal_tolerance_[i].holds(report_[i].error)) {
        arrived_[i] = true;
      } else if (!(time_s < segment.endS() + goal_time_s_)) {
        return fail(GoalState::kGoalViolated, i, " goal error ");
      }
    }
  }
  if (std::all_of(arrived_.begin(), arrived_.end(), [](bool each) { return each; })) {
    goal_state_ = GoalState::kSucceeded;
  }
}

// --- the whole state ------------------------------------------------------------------------------------------------

void visit(Archive& archive, Segment& segment) {
  archive(segment.start_s_, segment.duration_s_, segment.c_, segment.of_goal);
}

void visit(Archive& archive, JointPath& path) { archive(path.segments()); }

void visit(Archive& archive, Tolerance& tolerance) {
  archive(tolerance.position, tolerance.velocity, tolerance.acceleration);
}

void visit(Archive& archive, TrajectoryState& state) { archive(state.position, state.velocity, state.acceleration); }

void TrajectoryController::visit(Archive& archive) {
  archive(paths_);
  for (JointReport& report : report_) archive(report.desired, report.actual, report.error);
  for (Pid& pid : pids_) {
    PidState state = pid.state();
    archive(state.error, state.last_error, state.error_dot, state.integral, state.command, state.last_error_valid);
    pid.setState(state);
  }
  archive(goal_state_, goal_error_, goals_, path_tolerance_, goal_tolerance_, goal_time_s_, arrived_);
}

namespace {

ControllerType driveOf(const std::string& type) {
  const std::string interface = interfaceOfType(type);
  if (interface == "Position") return ControllerType::kPosition;
  return interface == "Velocity" ? ControllerType::kVelocity : ControllerType::kEffortPosition;
}

std::unique_ptr<Controller> make(const std::string& name, const std::string& type, const YAML::Node& parameters,
                                 const RobotModel& model, std::vector<std::string>& warnings) {
  std::vector<ControllerConfig> drives;
  const auto keys = readController<TrajectoryControllerConfig>(
      parameters, name, warnings, [&](const TrajectoryControllerConfig& given, const SectionCheck& section) {
        for (const std::string& joint : given.joints) {
          ControllerConfig drive;
          drive.name = name + "/gains/" + joint;
          drive.type = driveOf(type);
          drive.joint = joint;
          checkJoint(model, joint, drive.type, name, section.faults());
          drives.push_back(std::move(drive));
        }
      });
  TrajectoryController::Settings settings;
  settings.goal_time_s = keys.constraints.goal_time;
  settings.stop_duration_s = keys.stop_trajectory_duration;
  settings.state_rate_hz = keys.state_publish_rate;
  settings.monitor_rate_hz = keys.action_monitor_rate;
  settings.partial_joints = keys.allow_partial_joints_goal;
  for (ControllerConfig& drive : drives) {
    const std::string& joint = drive.joint;
    if (drive.type != ControllerType::kPosition) {
      if (const auto gains = keys.gains.find(joint); gains != keys.gains.end()) {
        drive.gains = gainsOf(gains->second);
      } else {
        warnings.push_back(drive.name + ": is missing, so this joint follows nothing");
      }
    }
    const auto found = keys.constraints.others.find(joint);
    const JointConstraints limits = found == keys.constraints.others.end() ? JointConstraints() : found->second;
    const auto forward = keys.velocity_ff.find(joint);
    settings.path.push_back({limits.trajectory, 0.0, 0.0});
    settings.goal.push_back({limits.goal, keys.constraints.stopped_velocity_tolerance, 0.0});
    settings.velocity_gain.push_back(forward == keys.velocity_ff.end() ? 0.0 : forward->second);
    settings.continuous.push_back(model.movingJoint(model.jointIndex(joint)).type == JointType::kContinuous);
  }
  return std::make_unique<TrajectoryController>(name, type, std::move(drives), std::move(settings));
}

const RegisterController kTypes[] = {{"effort_controllers/JointTrajectoryController", make},
                                     {"position_controllers/JointTrajectoryController", make},
                                     {"velocity_controllers/JointTrajectoryController", make},
                                     {"pos_vel_controllers/JointTrajectoryController", make}};

}  // namespace

}  // namespace aras_visual_servo_sim
