#pragma once

#include <aras_visual_servo_msgs/PauseAt.h>
#include <aras_visual_servo_msgs/RestoreState.h>
#include <aras_visual_servo_msgs/SaveState.h>
#include <aras_visual_servo_msgs/SetJointPositions.h>
#include <aras_visual_servo_msgs/SetTargetPose.h>
#include <aras_visual_servo_msgs/SimStatus.h>
#include <aras_visual_servo_msgs/Step.h>
#include <ros/callback_queue.h>
#include <ros/node_handle.h>
#include <std_srvs/Empty.h>
#include <std_srvs/Trigger.h>

#include <optional>
#include <string>
#include <vector>

#include "aras_visual_servo_sim/simulation/simulation.hpp"
#include "aras_visual_servo_sim/simulation/state/snapshots.hpp"
#include "aras_visual_servo_sim/simulation/time/lockstep_gate.hpp"
#include "convert/parameters.hpp"
#include "convert/wire_time.hpp"
#include "listen/command_inputs.hpp"
#include "listen/model_services.hpp"
#include "listen/pid_servers.hpp"
#include "nodelets.hpp"
#include "pacer.hpp"
#include "publish/camera_topics.hpp"
#include "publish/scene_markers.hpp"
#include "publish/state_publisher.hpp"
#include "record/recording.hpp"

namespace aras_visual_servo_sim {

/** The simulator as a ROS node: one thread that steps, publishes, and answers calls and commands.
 *
 *  Callbacks run between steps only, so they may touch the simulation. While it waits (paused, holding, or ahead of its
 *  pace) the thread sleeps on the callback queue and a message wakes it at once. */
class SimNode {
 public:
  /** @param queue  the callback queue `node` delivers to  @param nodelets  what those without threads have to do
   *  @throws ArasError */
  SimNode(ros::NodeHandle& node, ros::CallbackQueue& queue, NodeletQueue& nodelets, const NodeParameters& parameters);

  /** Returns when ROS shuts down. */
  void run();

 private:
  using Empty = std_srvs::Empty;
  using Trigger = std_srvs::Trigger;
  using PauseAt = aras_visual_servo_msgs::PauseAt;
  using Step = aras_visual_servo_msgs::Step;
  using SetJointPositions = aras_visual_servo_msgs::SetJointPositions;
  using SetTargetPose = aras_visual_servo_msgs::SetTargetPose;
  using SaveState = aras_visual_servo_msgs::SaveState;
  using RestoreState = aras_visual_servo_msgs::RestoreState;

  void advertiseServices(bool gazebo_names);
  bool onPause(Empty::Request&, Empty::Response&);
  bool onPauseAt(PauseAt::Request& request, PauseAt::Response& response);
  bool onUnpause(Empty::Request&, Empty::Response&);
  bool onReset(Empty::Request&, Empty::Response&);
  bool onResetWorld(Empty::Request&, Empty::Response&);
  /** Takes over what the parameters say now of cameras, light and pace. */
  bool onReconfigure(Trigger::Request&, Trigger::Response& response);
  bool onStep(Step::Request& request, Step::Response& response);
  bool onSetJointPositions(SetJointPositions::Request& request, SetJointPositions::Response& response);
  bool onSetTargetPose(SetTargetPose::Request& request, SetTargetPose::Response& response);
  bool onSaveState(SaveState::Request& request, SaveState::Response& response);
  bool onRestoreState(RestoreState::Request& request, RestoreState::Response& response);

  std::vector<std::string> lockstepNodes() const;
  void wait(double limit_s);
  void sample();
  void hold(const std::vector<int>& cameras);
  void timeJumped(std::int64_t before_ns);
  void advance(std::int64_t limit_ticks);
  bool pauseIfDue();
  void checkHold();
  void beat();
  void tellWarnings();
  std::string heldBy() const;
  void publishStatus();

  ros::NodeHandle node_;
  ros::CallbackQueue& queue_;
  NodeletQueue& nodelets_;
  TimeConfig config_;
  YAML::Node sim_section_;  ///< as it was taken over last
  Simulation simulation_;
  WireTime time_;
  std::vector<CameraTopics> camera_topics_;
  LockstepGate gate_;
  Pacer pacer_;
  RateMeter meter_;
  Recording recording_;
  StatePublisher states_;
  CommandInputs commands_;
  PidServers pids_;
  SceneMarkers markers_;
  ModelServices models_;
  ros::Publisher status_;
  std::vector<ros::ServiceServer> services_;
  bool paused_;
  std::optional<std::int64_t> pause_tick_;  ///< at which it pauses itself
  double real_time_factor_ = 0.0;           ///< reached
  std::uint64_t unanswered_ = 0;            ///< images the lockstep went on without an answer to
  std::vector<int> lockstep_cameras_;       ///< by index
  std::string held_image_;                  ///< the image that the lockstep waits for, in words
  std::string answerers_;                   ///< nodes that might answer it, in words; "" until the master was asked
  Snapshots snapshots_;
  std::size_t warnings_told_ = 0;     ///< of the simulation
  std::uint64_t clock_beats_at_ = 0;  ///< ticks when the clock was last repeated
  ros::WallTime next_beat_, hold_report_;
};

}  // namespace aras_visual_servo_sim
