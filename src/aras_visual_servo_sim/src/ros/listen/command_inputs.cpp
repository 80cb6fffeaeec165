#include "command_inputs.hpp"

#include <ros/console.h>
#include <ros/names.h>
#include <ros/transport_hints.h>
#include <std_msgs/Empty.h>

#include <algorithm>
#include <boost/function.hpp>
#include <boost/make_shared.hpp>
#include <cmath>
#include <map>
#include <optional>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "aras_visual_servo_sim/config/section.hpp"
#include "convert/conversions.hpp"
#include "neighbours.hpp"

namespace aras_visual_servo_sim {
namespace {

constexpr std::uint32_t kCommandQueue = 1000;  // messages
constexpr double kWarnPeriodS = 1.0;           // wall, between two warnings

void readArray(const std::string& kind, const std::vector<std::string>& names, const std::vector<double>& values,
               std::map<std::string, double>& to) {
  if (!values.empty() && values.size() != names.size()) {
    throw ShapeError("joint_command: " + kind + " has " + std::to_string(values.size()) + " entries, allowed 0 or " +
                     std::to_string(names.size()) + " (one for each name)");
  }
  for (std::size_t k = 0; k < values.size(); ++k) {
    if (!std::isnan(values[k])) to[names[k]] = values[k];  // the core refuses infinite values
  }
}

}  // namespace

JointCommand commandFromMessage(const sensor_msgs::JointState& message) {
  JointCommand command;
  readArray("position", message.name, message.position, command.position);
  readArray("velocity", message.name, message.velocity, command.velocity);
  readArray("effort", message.name, message.effort, command.effort);
  for (const std::string& joint : message.name) {
    if (command.position.count(joint) + command.velocity.count(joint) + command.effort.count(joint) == 0) {
      throw NotFiniteError("joint_command: joint '" + joint + "': no finite position, velocity or effort");
    }
  }
  return command;
}

CommandInputs::CommandInputs(ros::NodeHandle& node, Simulation& simulation, LockstepGate& gate, const WireTime& time,
                             const std::vector<CameraTopics>& topics)
    : simulation_(simulation), gate_(gate), time_(time) {
  const ros::TransportHints hints = ros::TransportHints().tcpNoDelay();
  joint_command_ = node.subscribe("joint_command", kCommandQueue, &CommandInputs::onJointCommand, this, hints);
  if (simulation.body().drivenBase()) {
    twist_command_ = node.subscribe("twist_command", kCommandQueue, &CommandInputs::onTwistCommand, this, hints);
  }
  for (const std::string& controller : simulation.body().controllerNames()) {
    const boost::function<void(const std_msgs::Float64::ConstPtr&)> callback =
        [this, controller](const std_msgs::Float64::ConstPtr& message) { onControllerCommand(controller, message); };
    controller_commands_.push_back(node.subscribe<std_msgs::Float64>(controller + "/command", kCommandQueue, callback,
                                                                     ros::VoidConstPtr(), hints));
  }
  for (std::size_t k = 0; k < topics.size(); ++k) {
    const int camera = static_cast<int>(k);
    if (!simulation.cameras()[camera].model().config().triggered) continue;
    triggers_.push_back(node.subscribe<std_msgs::Empty>(
        topics[k].trigger, 1, [this, camera](const std_msgs::EmptyConstPtr&) { simulation_.trigger(camera); }));
  }
}

void CommandInputs::onJointCommand(const ros::MessageEvent<const sensor_msgs::JointState>& event) {
  receive({event.getPublisherName(), event.getConstMessage(), ""});
}

void CommandInputs::onTwistCommand(const ros::MessageEvent<const geometry_msgs::TwistStamped>& event) {
  const geometry_msgs::TwistStamped& from = *event.getConstMessage();
  const geometry_msgs::Vector3 &v = from.twist.linear, &w = from.twist.angular;
  const auto message = boost::make_shared<sensor_msgs::JointState>();
  message->header = from.header;
  std::string refusal;
  try {
    const Twist twist = (Twist() << v.x, v.y, v.z, w.x, w.y, w.z).finished();
    if (!twist.allFinite()) throw NotFiniteError("twist_command: found a value that is not finite");
    for (const auto& [name, value] : simulation_.body().twistCommand(twist, from.header.frame_id).velocity) {
      message->name.push_back(name);
      message->velocity.push_back(value);
    }
  } catch (const ArasError& error) {
    refusal = error.what();
  }
  receive({event.getPublisherName(), message, refusal});
}

void CommandInputs::timeJumped(std::int64_t before_ns) {
  kept_.clear();
  arrived_.clear();
  before_jump_ns_ = before_ns;
}

/** Whether the command was on its way when time was set back: its stamp is one of the time that is gone, and its sender
 *  has sent none of the time since. */
bool CommandInputs::overtaken(const Kept& command) {
  const ros::Time& stamp = command.message->header.stamp;
  if (stamp.isZero()) return false;
  const std::int64_t stamp_ns = time_.simulated(stamp);
  if (stamp_ns <= simulation_.timeNs()) arrived_.insert(command.sender);
  return stamp_ns <= before_jump_ns_ && arrived_.count(command.sender) == 0;
}

void CommandInputs::receive(const Kept& command) {
  if (overtaken(command)) {
    ROS_DEBUG("a command of %s was sent before time was set back: dropped", command.sender.c_str());
    return;
  }
  if (gate_.holding() && !gate_.nodes().empty()) {
    kept_.push_back(command);
  } else {
    apply(command);
  }
  // A stamp from the future is no answer: its sender runs on another clock.
  const std::int64_t stamp_ns = time_.simulated(command.message->header.stamp);
  gate_.commandReceived(stamp_ns <= simulation_.timeNs() ? stamp_ns : -1, command.sender);
  if (!gate_.holding()) applyKept();
}

void CommandInputs::applyKept() {
  std::stable_sort(kept_.begin(), kept_.end(), [](const Kept& a, const Kept& b) { return a.sender < b.sender; });
  for (const Kept& kept : kept_) apply(kept);
  kept_.clear();
}

void CommandInputs::apply(const Kept& received) {
  const sensor_msgs::JointState& message = *received.message;
  try {
    JointCommand command;
    try {
      if (!received.refusal.empty()) throw ParameterError(received.refusal);
      command = commandFromMessage(message);
    } catch (const ArasError& error) {
      simulation_.refuse(error.what());
      throw;
    }
    std::optional<std::int64_t> stamp_ns;
    if (!message.header.stamp.isZero()) stamp_ns = time_.simulated(message.header.stamp);
    simulation_.setCommand(command, stamp_ns);
  } catch (const ArasError& error) {
    ROS_WARN_THROTTLE(kWarnPeriodS, "command refused, the arm holds: %s", error.what());
  }
}

void CommandInputs::onControllerCommand(const std::string& controller, const std_msgs::Float64::ConstPtr& message) {
  try {
    simulation_.setControllerCommand(controller, message->data);
  } catch (const ArasError& error) {
    ROS_WARN_THROTTLE(kWarnPeriodS, "command refused, the arm holds: %s/command: %s", controller.c_str(), error.what());
  }
}

std::string CommandInputs::answerers() const {
  const std::string topic = joint_command_.getTopic();
  const std::string names = joined(publishersOf(topic));
  return names.empty() ? "nobody publishes " + topic
                       : names + " (" + std::to_string(joint_command_.getNumPublishers()) + " connected)";
}

}  // namespace aras_visual_servo_sim
