#pragma once

#include <geometry_msgs/TwistStamped.h>
#include <ros/message_event.h>
#include <ros/node_handle.h>
#include <ros/subscriber.h>
#include <sensor_msgs/JointState.h>
#include <std_msgs/Float64.h>

#include <cstdint>
#include <limits>
#include <set>
#include <string>
#include <vector>

#include "aras_visual_servo_sim/simulation/simulation.hpp"
#include "aras_visual_servo_sim/simulation/time/lockstep_gate.hpp"
#include "convert/wire_time.hpp"
#include "publish/camera_topics.hpp"

namespace aras_visual_servo_sim {

/** A stamped command as the core wants it. NaN entries are left out; a joint without any finite one is a fault.
 *  @throws ShapeError if an array is neither empty nor as long as `name`; NotFiniteError naming the joint */
JointCommand commandFromMessage(const sensor_msgs::JointState& message);

/** Listens to `joint_command`, every `<controller>/command` and, for a driven base, `twist_command`. A command that is
 *  refused never stops the node: it is counted, warned about, and the arm holds. Listens to std_msgs/Empty on
 *  <camera>/image_trigger of triggered cameras too, as gazebo_ros_triggered_camera does; the plugin's
 *  <triggerTopicName> is the topic's name where the URDF has that camera.
 *
 *  Where the lockstep waits for several nodes, the joint commands that arrive while it holds are kept, and applied when
 *  time goes on in the order of their senders' names. So it does not matter which node was faster. */
class CommandInputs {
 public:
  /** @param topics  of the cameras */
  CommandInputs(ros::NodeHandle& node, Simulation& simulation, LockstepGate& gate, const WireTime& time,
                const std::vector<CameraTopics>& topics);

  /** Applies the commands that were kept; to be called when the lockstep lets time go on. */
  void applyKept();
  /** Forgets them; to be called when the simulation's time has jumped, as by a reset. It was before_ns. */
  void timeJumped(std::int64_t before_ns);

  /** Names of the nodes that publish `joint_command`, in words; asks the master. */
  std::string answerers() const;

 private:
  struct Kept {
    std::string sender;
    sensor_msgs::JointState::ConstPtr message;
    std::string refusal;  ///< why the message cannot be read, "": it can
  };
  void onJointCommand(const ros::MessageEvent<const sensor_msgs::JointState>& event);
  /** In the frame of its header, a link that the base carries; answers images as a joint command does. */
  void onTwistCommand(const ros::MessageEvent<const geometry_msgs::TwistStamped>& event);
  void receive(const Kept& command);
  bool overtaken(const Kept& command);
  void apply(const Kept& command);
  void onControllerCommand(const std::string& controller, const std_msgs::Float64::ConstPtr& message);

  Simulation& simulation_;
  LockstepGate& gate_;
  const WireTime& time_;
  std::vector<Kept> kept_;
  std::int64_t before_jump_ns_ = std::numeric_limits<std::int64_t>::min();  ///< the time from which it jumped
  std::set<std::string> arrived_;  ///< senders that have used the time since then
  ros::Subscriber joint_command_, twist_command_;
  std::vector<ros::Subscriber> controller_commands_, triggers_;
};

}  // namespace aras_visual_servo_sim
