#include "command_inputs.hpp"

#include <ros/console.h>
#include <ros/master.h>
#include <ros/names.h>
#include <ros/this_node.h>
#include <ros/transport_hints.h>

#include <boost/function.hpp>
#include <cmath>
#include <limits>
#include <map>
#include <optional>

#include "aras_visual_servo_sim/errors.hpp"
#include "conversions.hpp"

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
    if (!std::isnan(values[k])) to[names[k]] = values[k];  // infinities are for the core to refuse
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

CommandInputs::CommandInputs(ros::NodeHandle& node, Simulation& simulation, LockstepGate& gate)
    : simulation_(simulation), gate_(gate) {
  const ros::TransportHints hints = ros::TransportHints().tcpNoDelay();
  joint_command_ = node.subscribe("joint_command", kCommandQueue, &CommandInputs::onJointCommand, this, hints);
  for (const std::string& controller : simulation.world().controllerNames()) {
    const boost::function<void(const std_msgs::Float64::ConstPtr&)> callback =
        [this, controller](const std_msgs::Float64::ConstPtr& message) { onControllerCommand(controller, message); };
    controller_commands_.push_back(node.subscribe<std_msgs::Float64>(controller + "/command", kCommandQueue, callback,
                                                                     ros::VoidConstPtr(), hints));
  }
}

void CommandInputs::onJointCommand(const sensor_msgs::JointState::ConstPtr& message) {
  const std::int64_t stamp_ns = toNanoseconds(message->header.stamp);
  // A stamp from the future answers nothing: its sender lives in another time.
  const std::int64_t answered_ns = stamp_ns <= simulation_.timeNs() ? stamp_ns : -1;
  try {
    JointCommand command;
    try {
      command = commandFromMessage(*message);
    } catch (const ArasError& error) {
      simulation_.refuse(error.what());
      throw;
    }
    const bool unstamped = message->header.stamp.isZero();
    simulation_.setCommand(command, unstamped ? std::nullopt : std::optional<std::int64_t>(stamp_ns));
  } catch (const ArasError& error) {
    ROS_WARN_THROTTLE(kWarnPeriodS, "command refused, the arm holds: %s", error.what());
  }
  gate_.commandReceived(answered_ns);
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
  XmlRpc::XmlRpcValue request, response, state;
  request[0] = ros::this_node::getName();
  std::string names;
  if (ros::master::execute("getSystemState", request, response, state, false)) {
    XmlRpc::XmlRpcValue& publishers = state[0];
    for (int k = 0; k < publishers.size(); ++k) {
      if (static_cast<std::string>(publishers[k][0]) != topic) continue;
      for (int j = 0; j < publishers[k][1].size(); ++j) {
        names += (names.empty() ? "" : ", ") + static_cast<std::string>(publishers[k][1][j]);
      }
    }
  }
  return names.empty() ? "nobody publishes " + topic
                       : names + " (" + std::to_string(joint_command_.getNumPublishers()) + " connected)";
}

}  // namespace aras_visual_servo_sim
