#include "sim_node.hpp"

#include <ros/console.h>
#include <ros/init.h>

#include <algorithm>

#include "aras_visual_servo_sim/errors.hpp"
#include "conversions.hpp"

namespace aras_visual_servo_sim {
namespace {

constexpr double kBeatPeriodS = 0.1;        // wall: status, and /clock while time stands still
constexpr std::int64_t kSliceNs = 1000000;  // simulated time between two looks at the messages when paced

}  // namespace

SimNode::SimNode(ros::NodeHandle& node, ros::CallbackQueue& queue, const NodeParameters& parameters)
    : node_(node),
      queue_(queue),
      time_(parameters.time),
      simulation_(parameters.robot, parameters.simulation, parameters.controllers),
      gate_(parameters.time.lockstep),
      pacer_(parameters.time.real_time_factor),
      states_(node_, simulation_, parameters.time),
      commands_(node_, simulation_, gate_),
      pids_(node_, simulation_),
      markers_(node_, simulation_.model().links.front().name),
      status_(node_.advertise<aras_visual_servo_msgs::SimStatus>("sim/status", 1000, true)),
      paused_(parameters.time.start_paused) {
  for (const std::string& warning : simulation_.model().warnings) ROS_WARN("%s", warning.c_str());
  advertiseServices(parameters.gazebo_names);
  markers_.publish(simulation_.scene());
}

void SimNode::run() {
  pacer_.restart(simulation_.timeNs());
  meter_.restart(simulation_.timeNs());
  while (ros::ok()) {
    queue_.callAvailable(ros::WallDuration(0.0));
    beat();
    if (paused_) {
      wait(kBeatPeriodS);
    } else if (gate_.holding()) {
      checkHold();
      wait(kBeatPeriodS);
    } else {
      sample();
      if (gate_.holding()) continue;
      const double ahead_s = pacer_.ahead(simulation_.timeNs());
      if (ahead_s > 0.0) {
        wait(ahead_s);
      } else {
        advance(pacer_.paced() ? std::max<std::int64_t>(1, kSliceNs / simulation_.periodNs()) : INT64_MAX);
      }
    }
  }
}

void SimNode::wait(double limit_s) {
  const double beat_s = (next_beat_ - ros::WallTime::now()).toSec();
  queue_.callOne(ros::WallDuration(std::clamp(std::min(limit_s, beat_s), 0.0, limit_s)));
}

void SimNode::sample() {
  if (!states_.publishDue()) return;
  gate_.imageSent(simulation_.timeNs());
  hold_report_ = ros::WallTime::now() + ros::WallDuration(time_.lockstep_timeout_s);
}

void SimNode::advance(std::int64_t limit_ticks) {
  const std::int64_t to_sample = states_.nextTick() - simulation_.ticks();
  simulation_.step(std::clamp<std::int64_t>(to_sample, 1, limit_ticks));
}

void SimNode::checkHold() {
  const ros::WallTime now = ros::WallTime::now();
  if (now < hold_report_) return;
  hold_report_ = now + ros::WallDuration(time_.lockstep_timeout_s);
  const std::string stamp = std::to_string(1e-9 * static_cast<double>(gate_.waitingForNs()));
  held_by_ = "no answer to the image of " + stamp + " s on joint_command from: " + commands_.answerers();
  ROS_WARN("lockstep: %s; %s", held_by_.c_str(), time_.continue_on_timeout ? "going on" : "still holding");
  if (time_.continue_on_timeout) {
    ++unanswered_;
    gate_.release();
  }
  publishStatus();
}

/** What happens ten times a second of wall time, whatever the simulation does. */
void SimNode::beat() {
  const ros::WallTime now = ros::WallTime::now();
  if (now < next_beat_) return;
  next_beat_ = now + ros::WallDuration(kBeatPeriodS);
  real_time_factor_ = meter_.update(simulation_.timeNs());
  const auto ticks = static_cast<std::uint64_t>(simulation_.ticks());
  if (paused_ || gate_.holding() || ticks == clock_beats_at_) states_.publishClock();
  clock_beats_at_ = ticks;
  publishStatus();
}

void SimNode::publishStatus() {
  aras_visual_servo_msgs::SimStatus status;
  status.header.stamp = toRosTime(simulation_.timeNs());
  status.real_time_factor = real_time_factor_;
  status.paused = paused_;
  status.lockstep = time_.lockstep;
  status.lockstep_armed = gate_.armed();
  status.holding = gate_.holding() && !paused_;
  if (!gate_.holding()) held_by_.clear();
  if (status.holding) status.held_by = held_by_.empty() ? "joint_command" : held_by_;
  status.ticks = static_cast<std::uint64_t>(simulation_.ticks());
  status.frames = states_.frames();
  status.dropped_frames = states_.droppedFrames() + unanswered_;
  status.refused_commands = simulation_.refusedCommands();
  status.last_refusal = simulation_.lastRefusal();
  status.run_hash = simulation_.runHash();
  status_.publish(status);
}

}  // namespace aras_visual_servo_sim
