#include "parameters.hpp"

#include <algorithm>
#include <string>
#include <vector>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "aras_visual_servo_sim/robot/urdf_loader.hpp"
#include "conversions.hpp"

namespace aras_visual_servo_sim {
namespace {

const std::vector<std::string> kPrivateKeys = {"base_tf", "gazebo_camera_names", "gazebo_names", "scenario", "sim",
                                               "time"};
const std::string kControllerSuffix = "Controller";

bool endsWith(const std::string& text, const std::string& suffix) {
  return text.size() >= suffix.size() && text.compare(text.size() - suffix.size(), suffix.size(), suffix) == 0;
}

YAML::Node section(const ros::NodeHandle& node, const ros::NodeHandle& private_node, const std::string& name) {
  XmlRpc::XmlRpcValue value;
  if (private_node.getParam(name, value) || private_node.getParam("scenario/" + name, value) ||
      node.getParam("scenario/" + name, value)) {
    return toYaml(value);
  }
  return YAML::Node();
}

/** A file that begins with the robot's name, as Gazebo packages have it, loaded into the robot's namespace: everything
 *  is put where it would be in Gazebo, for whoever else reads it. */
void liftNested(const ros::NodeHandle& node) {
  XmlRpc::XmlRpcValue nested;
  const std::string name = node.getNamespace().substr(node.getNamespace().rfind('/') + 1);
  if (name.empty() || !node.getParam(name, nested) || nested.getType() != XmlRpc::XmlRpcValue::TypeStruct) return;
  node.deleteParam(name);
  for (auto& [key, value] : nested) node.setParam(key, value);
}

YAML::Node findControllers(const ros::NodeHandle& node) {
  YAML::Node controllers(YAML::NodeType::Map);
  XmlRpc::XmlRpcValue tree;
  if (!node.getParam(node.getNamespace(), tree) || tree.getType() != XmlRpc::XmlRpcValue::TypeStruct) {
    return controllers;
  }
  if (tree.hasMember("joint_limits")) controllers["joint_limits"] = toYaml(tree["joint_limits"]);
  for (auto& [name, value] : tree) {
    if (value.getType() != XmlRpc::XmlRpcValue::TypeStruct || !value.hasMember("type")) continue;
    XmlRpc::XmlRpcValue& type = value["type"];
    if (type.getType() == XmlRpc::XmlRpcValue::TypeString && endsWith(type, kControllerSuffix)) {
      controllers[name] = toYaml(value);
    }
  }
  return controllers;
}

void refuseUnknownKeys(const ros::NodeHandle& private_node, std::vector<std::string>& faults) {
  XmlRpc::XmlRpcValue tree;
  if (!private_node.getParam(private_node.getNamespace(), tree)) return;
  if (tree.getType() != XmlRpc::XmlRpcValue::TypeStruct) return;
  for (auto& member : tree) {
    if (std::find(kPrivateKeys.begin(), kPrivateKeys.end(), member.first) == kPrivateKeys.end()) {
      faults.push_back("~" + member.first +
                       ": unknown key, allowed base_tf, gazebo_camera_names, gazebo_names, scenario, sim, time");
    }
  }
}

}  // namespace

NodeParameters loadParameters(const ros::NodeHandle& node, const ros::NodeHandle& private_node) {
  NodeParameters parameters;
  std::vector<std::string> faults;
  const auto collect = [&faults](const auto& action) {
    try {
      action();
    } catch (const ArasError& error) {
      faults.emplace_back(error.what());
    }
  };
  refuseUnknownKeys(private_node, faults);
  private_node.param("gazebo_names", parameters.gazebo_names, false);
  private_node.param("gazebo_camera_names", parameters.gazebo_camera_names, false);
  private_node.param("base_tf", parameters.base_tf, true);
  collect([&] { parameters.simulation = SimulationConfig::fromYaml(section(node, private_node, "sim")); });
  const YAML::Node time = section(node, private_node, "time");
  collect([&] { parameters.time = TimeConfig::fromYaml(time); });
  liftNested(node);
  parameters.controllers = findControllers(node);

  std::string urdf, key;
  if (!node.searchParam("robot_description", key) || !node.getParam(key, urdf)) {
    faults.push_back("robot_description: not found in " + node.getNamespace() + " or above, must be a URDF document");
  } else {
    collect([&] {
      parameters.robot = loadRobotModel(urdf, key);
      parseControllers(parameters.controllers, parameters.robot);
      parameters.joint_states = parseJointStates(parameters.controllers, parameters.robot);
    });
  }
  const bool rate_given = time.IsMap() && time["joint_state_rate_hz"].IsDefined();
  if (!rate_given && parameters.joint_states.publish_rate_hz) {
    parameters.time.joint_state_rate_hz = *parameters.joint_states.publish_rate_hz;
  }
  if (!faults.empty()) {
    std::string text;
    for (const std::string& fault : faults) text += (text.empty() ? "" : "\n") + fault;
    throw ParameterError(text);
  }
  return parameters;
}

}  // namespace aras_visual_servo_sim
