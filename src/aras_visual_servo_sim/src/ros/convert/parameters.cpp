#include "parameters.hpp"

#include <aras_visual_servo_common/ros/yaml_from_xmlrpc.hpp>
#include <string>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "aras_visual_servo_sim/config/section.hpp"
#include "aras_visual_servo_sim/robot/urdf_loader.hpp"

namespace aras_visual_servo_sim {
namespace {

using aras_visual_servo_common::yamlFromXmlRpc;

const std::string kControllerSuffix = "Controller";

bool endsWith(const std::string& text, const std::string& suffix) {
  return text.size() >= suffix.size() && text.compare(text.size() - suffix.size(), suffix.size(), suffix) == 0;
}

YAML::Node section(const ros::NodeHandle& node, const ros::NodeHandle& private_node, const std::string& name) {
  XmlRpc::XmlRpcValue value;
  if (private_node.getParam(name, value) || private_node.getParam("scenario/" + name, value) ||
      node.getParam("scenario/" + name, value)) {
    return yamlFromXmlRpc(value);
  }
  return YAML::Node();
}

/** The private parameters of the node itself; those in sections are read with their sections. */
YAML::Node ownParameters(const ros::NodeHandle& private_node) {
  YAML::Node own(YAML::NodeType::Map);
  XmlRpc::XmlRpcValue tree;
  if (!private_node.getParam(private_node.getNamespace(), tree)) return own;
  if (tree.getType() != XmlRpc::XmlRpcValue::TypeStruct) return own;
  for (auto& [name, value] : tree) {
    if (name == kSegmentationIds) continue;  // a predecessor has left it
    const bool is_section = name == "sim" || name == "time" || name == "scenario";
    own[name] = is_section ? YAML::Node(YAML::NodeType::Map) : yamlFromXmlRpc(value);
  }
  return own;
}

/** Handles a controllers file that begins with the robot's name (Gazebo packages have such files) and was loaded into
 *  the robot's namespace: everything is moved to where it would be in Gazebo, where other nodes look for it. */
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
  if (tree.hasMember("joint_limits")) controllers["joint_limits"] = yamlFromXmlRpc(tree["joint_limits"]);
  for (auto& [name, value] : tree) {
    if (value.getType() != XmlRpc::XmlRpcValue::TypeStruct || !value.hasMember("type")) continue;
    XmlRpc::XmlRpcValue& type = value["type"];
    if (type.getType() == XmlRpc::XmlRpcValue::TypeString && endsWith(type, kControllerSuffix)) {
      controllers[name] = yamlFromXmlRpc(value);
    }
  }
  return controllers;
}

/** The section `sim` in three parts, as text. */
struct Split {
  std::string cameras, lighting, rest;
};

Split split(const YAML::Node& sim) {
  Split parts;
  YAML::Node rest = sim.IsMap() ? YAML::Clone(sim) : YAML::Node(YAML::NodeType::Map), lighting;
  if (rest["cameras"]) parts.cameras = YAML::Dump(rest["cameras"]);
  rest.remove("cameras");
  if (YAML::Node scene = rest["scene"]; scene.IsMap()) {
    for (const char* key : {"background_rgb", "light_direction", "lighting"}) {
      if (!scene[key]) continue;
      lighting[key] = YAML::Clone(scene[key]);
      scene.remove(key);
    }
  }
  if (lighting.IsMap()) parts.lighting = YAML::Dump(lighting);
  parts.rest = YAML::Dump(rest);
  return parts;
}

}  // namespace

NodeParameters loadParameters(const ros::NodeHandle& node, const ros::NodeHandle& private_node) {
  NodeParameters parameters;
  FaultList faults;
  faults.collect(
      [&] {
        const auto take = [&](const NodeConfig& own, const SectionCheck&) { parameters.own = own; };
        readSection<NodeConfig>(ownParameters(private_node), "", take);
      },
      "~");
  faults.collect([&] { parameters.simulation = SimulationConfig::fromYaml(section(node, private_node, "sim")); });
  faults.collect([&] { parameters.time = TimeConfig::fromYaml(section(node, private_node, "time")); });
  liftNested(node);
  parameters.controllers = findControllers(node);

  std::string urdf, key;
  if (!node.searchParam("robot_description", key) || !node.getParam(key, urdf)) {
    faults.add("robot_description: not found in " + node.getNamespace() + " or above, must be a URDF document");
  } else {
    faults.collect([&] {
      parameters.robot = loadRobotModel(urdf, key);
      parseControllers(parameters.controllers, parameters.robot);
      parameters.joint_states = parseJointStates(parameters.controllers, parameters.robot);
    });
  }
  if (!parameters.time.joint_state_rate_given && parameters.joint_states.publish_rate_hz) {
    parameters.time.joint_state_rate_hz = *parameters.joint_states.publish_rate_hz;
  }
  faults.throwIfAny();
  return parameters;
}

YAML::Node simSection(const ros::NodeHandle& node, const ros::NodeHandle& private_node) {
  return section(node, private_node, "sim");
}

LiveParameters loadLiveParameters(const ros::NodeHandle& node, const ros::NodeHandle& private_node,
                                  const YAML::Node& before) {
  LiveParameters parameters;
  const YAML::Node sim = simSection(node, private_node);
  parameters.simulation = SimulationConfig::fromYaml(sim);
  parameters.real_time_factor = TimeConfig::fromYaml(section(node, private_node, "time")).real_time_factor;
  const Split now = split(sim), then = split(before);
  if (now.rest != then.rest) {
    throw ParameterError("sim: found other values than at the start beside those of cameras, background and lights, " +
                         std::string("allowed after a new start only"));
  }
  parameters.cameras = now.cameras != then.cameras;
  parameters.lighting = now.lighting != then.lighting;
  return parameters;
}

}  // namespace aras_visual_servo_sim
