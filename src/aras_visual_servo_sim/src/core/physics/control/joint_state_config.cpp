#include "aras_visual_servo_sim/physics/joint_state_config.hpp"

#include <algorithm>

namespace aras_visual_servo_sim {

JointStateConfig readJointStates(YamlReader& reader, const RobotModel& model) {
  JointStateConfig config;
  config.publish_rate_hz = reader.find<double>("publish_rate");
  for (YamlReader& entry : reader.list("extra_joints")) {
    const ExtraJoint joint{entry.get<std::string>("name"), entry.get<double>("position"), entry.get<double>("velocity"),
                           entry.get<double>("effort")};
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
  if (!controllers.IsMap()) return {};
  for (const auto& item : controllers) {
    if (!item.second.IsMap() || !item.second["type"].IsDefined()) continue;
    YamlReader reader(item.second, sectionOf("controller"), aras_visual_servo_common::nameIn(item.first));
    if (reader.find<std::string>("type") != kJointStateType) continue;
    const JointStateConfig config = readJointStates(reader, model);
    reader.finish();
    return config;
  }
  return {};
}

}  // namespace aras_visual_servo_sim
