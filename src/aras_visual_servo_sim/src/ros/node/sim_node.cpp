#include "sim_node.hpp"

#include <ros/console.h>
#include <ros/init.h>

#include <algorithm>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "aras_visual_servo_sim/config/section.hpp"
#include "convert/conversions.hpp"
#include "listen/neighbours.hpp"

namespace aras_visual_servo_sim {
namespace {

constexpr double kBeatPeriodS = 0.1;        // wall: status, and /clock while time stands still
constexpr std::int64_t kSliceNs = 1000000;  // simulated time between two looks at the messages when paced

}  // namespace

SimNode::SimNode(ros::NodeHandle& node, ros::CallbackQueue& queue, NodeletQueue& nodelets,
                 const NodeParameters& parameters)
    : node_(node),
      queue_(queue),
      nodelets_(nodelets),
      config_(parameters.time),
      sim_section_(simSection(node, ros::NodeHandle("~"))),
      simulation_(parameters.robot, parameters.simulation, parameters.controllers),
      time_(simulation_, parameters.time.monotonic_clock),
      camera_topics_(cameraTopics(simulation_, parameters.own.gazebo_camera_names)),
      gate_(parameters.time.lockstep, lockstepNodes()),
      pacer_(parameters.time.real_time_factor),
      recording_(node_, time_),
      states_(node_, simulation_, parameters, camera_topics_, time_, recording_),
      commands_(node_, simulation_, gate_, time_, camera_topics_),
      pids_(node_, simulation_),
      markers_(node_, simulation_),
      models_(node_, simulation_, markers_, time_),
      status_(node_.advertise<aras_visual_servo_msgs::SimStatus>("sim/status", 1000, true)),
      paused_(parameters.time.start_paused) {
  requireOwnClock(node_.resolveName("/clock"));
  tellWarnings();
  for (const std::string& camera : config_.lockstep_cameras) {
    lockstep_cameras_.push_back(simulation_.cameras().index(camera));
  }
  advertiseServices(parameters.own.gazebo_names);
  markers_.publish();
}

/** Full names of the nodes that have to answer each image. */
std::vector<std::string> SimNode::lockstepNodes() const {
  std::vector<std::string> nodes;
  for (const std::string& node : config_.lockstep_nodes) nodes.push_back(node_.resolveName(node, false));
  return nodes;
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
      if (pauseIfDue() || gate_.holding()) continue;
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
  recording_.flush();
  const double beat_s = (next_beat_ - ros::WallTime::now()).toSec();
  queue_.callOne(ros::WallDuration(std::clamp(std::min(limit_s, beat_s), 0.0, limit_s)));
}

void SimNode::sample() {
  hold(states_.publishDue());
  nodelets_.work();
  recording_.flush();
}

/** Lets the lockstep wait for the answers to the images of these cameras, which were just sent. */
void SimNode::hold(const std::vector<int>& cameras) {
  std::string names;
  std::int64_t newest_ns = 0;
  for (const int camera : cameras) {
    const bool counts = std::count(lockstep_cameras_.begin(), lockstep_cameras_.end(), camera) > 0;
    if (!counts && !lockstep_cameras_.empty()) continue;
    names += (names.empty() ? "" : ", ") + simulation_.cameras().names()[camera];
    newest_ns = std::max(newest_ns, states_.imageNs(camera));
  }
  if (names.empty()) return;
  gate_.imageSent(newest_ns);
  held_image_ = "image of " + names + " at " + std::to_string(time_.at(newest_ns).toSec()) + " s";
  answerers_.clear();
  hold_report_ = ros::WallTime::now() + ros::WallDuration(config_.lockstep_timeout_s);
}

/** To be called after a reset or a restored state: the lockstep waits for no answer any more. */
void SimNode::timeJumped(std::int64_t before_ns) {
  time_.jumped(before_ns);
  pause_tick_.reset();  // it was of the time before
  gate_.release();
  commands_.timeJumped(before_ns);
  pacer_.restart(simulation_.timeNs());
  meter_.restart(simulation_.timeNs());
  pids_.refresh();
  markers_.publish();
}

/** Whether the time has come at which it was to pause; it does so then. */
bool SimNode::pauseIfDue() {
  if (!pause_tick_ || simulation_.ticks() < *pause_tick_) return false;
  pause_tick_.reset();
  paused_ = true;
  publishStatus();
  return true;
}

void SimNode::advance(std::int64_t limit_ticks) {
  const std::int64_t to_sample = states_.nextTick() - simulation_.ticks();
  if (pause_tick_) limit_ticks = std::min(limit_ticks, std::max<std::int64_t>(1, *pause_tick_ - simulation_.ticks()));
  simulation_.step(std::clamp<std::int64_t>(to_sample, 1, limit_ticks));
}

void SimNode::checkHold() {
  const ros::WallTime now = ros::WallTime::now();
  if (now < hold_report_) return;
  hold_report_ = now + ros::WallDuration(config_.lockstep_timeout_s);
  answerers_ = commands_.answerers();
  ROS_WARN("lockstep: %s; %s", heldBy().c_str(), config_.continue_on_timeout ? "going on" : "still holding");
  if (config_.continue_on_timeout) {
    ++unanswered_;
    gate_.release();
    commands_.applyKept();
  }
  publishStatus();
}

/** Work that is done ten times per second of wall time, whatever the simulation does. */
void SimNode::beat() {
  const ros::WallTime now = ros::WallTime::now();
  if (now < next_beat_) return;
  next_beat_ = now + ros::WallDuration(kBeatPeriodS);
  real_time_factor_ = meter_.update(simulation_.timeNs());
  const auto ticks = static_cast<std::uint64_t>(simulation_.ticks());
  if (paused_ || gate_.holding() || ticks == clock_beats_at_) states_.publishClock();
  clock_beats_at_ = ticks;
  if (simulation_.modelsMove()) markers_.refresh();
  tellWarnings();
  publishStatus();
}

void SimNode::tellWarnings() {
  const std::vector<std::string>& all = simulation_.warnings();
  for (; warnings_told_ < all.size(); ++warnings_told_) ROS_WARN("%s", all[warnings_told_].c_str());
}

/** Sentence that says which nodes have not answered which image. */
std::string SimNode::heldBy() const {
  const std::string missing = joined({gate_.missing().begin(), gate_.missing().end()});
  const std::string to = " to the " + held_image_ + " on joint_command";
  if (answerers_.empty()) return "an answer" + to + (missing.empty() ? "" : " from: " + missing);
  if (missing.empty()) return "no answer" + to + " from: " + answerers_;
  return "no answer" + to + " from: " + missing + "; publishers: " + answerers_;
}

void SimNode::publishStatus() {
  aras_visual_servo_msgs::SimStatus status;
  status.header.stamp = time_.now();
  status.real_time_factor = real_time_factor_;
  status.paused = paused_;
  status.lockstep = config_.lockstep;
  status.lockstep_armed = gate_.armed();
  status.holding = gate_.holding() && !paused_;
  if (status.holding) status.held_by = heldBy();
  status.ticks = static_cast<std::uint64_t>(simulation_.ticks());
  status.frames = states_.frames();
  status.dropped_frames = states_.droppedFrames() + unanswered_;
  status.unsettled_steps = simulation_.body().unsettledSteps();
  status.refused_commands = simulation_.commands().refused();
  status.last_refusal = simulation_.commands().lastRefusal();
  status.opengl = simulation_.openGl();
  status.run_hash = simulation_.runHash();
  status.recording = recording_.running();
  status.recording_fault = recording_.fault();
  status_.publish(status);
}

}  // namespace aras_visual_servo_sim
