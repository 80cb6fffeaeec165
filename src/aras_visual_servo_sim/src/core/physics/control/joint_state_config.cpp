#include "aras_visual_servo_sim/physics/joint_state_config.hpp"

#include <algorithm>

namespace aras_visual_servo_sim {

JointStateConfig readJointStates(YamlReader& reader, const RobotModel& model) {
  JointStateConfig config;
  if (reader.has("publish_rate")) config.publish_rate_hz = reader.required<double>("publish_rate", Range::positive());
  for (YamlReader& entry : reader.list("extra_joints")) {
    ExtraJoint joint;
    joint.name = entry.required<std::string>("name");
    joint.position = entry.optional<double>("position", 0.0);
    joint.velocity = entry.optional<double>("velocity", 0.0);
    joint.effort = entry.optional<double>("effort", 0.0);
    const auto& moving = model.joint_names;
    const auto same = [&joint](const ExtraJoint& other) { return other.name == joint.name; };
    if (std::find(moving.begin(), moving.end(), joint.name) != moving.end()) continue;
    if (std::none_of(config.extra_joints.begin(), config.extra_joints.end(), same)) {
      config.extra_joints.push_back(joint);
    }
  }
  return config;
}

JointStateConfig parseJointStates(const YAML::Node& controllers, const RobotModel& model) {
  for (const auto& item : controllers) {
    if (!item.second.IsMap() || !item.second["type"].IsDefined()) continue;
    YamlReader reader(item.second, item.first.as<std::string>());
    if (reader.required<std::string>("type") != "joint_state_controller/JointStateController") continue;
    const JointStateConfig config = readJointStates(reader, model);
    reader.finish();
    return config;
  }
  return {};
}

}  // namespace aras_visual_servo_sim
