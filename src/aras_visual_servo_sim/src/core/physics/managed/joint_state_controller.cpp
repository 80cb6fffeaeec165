#include "aras_visual_servo_sim/physics/managed/joint_state_controller.hpp"

#include <algorithm>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "aras_visual_servo_sim/config/section.hpp"

namespace aras_visual_servo_sim {
namespace {

std::unique_ptr<Controller> make(const std::string& name, const std::string& type, const YAML::Node& parameters,
                                 const RobotModel& model, std::vector<std::string>& warnings) {
  JointStateConfig config =
      jointStatesOf(readController<ControllerKeys>(parameters, name, warnings, [](auto&&...) {}), model);
  if (!config.publish_rate_hz) {
    throw ParameterError(name + "/publish_rate: Parameter 'publish_rate' not set, allowed is a rate above 0 Hz");
  }
  return std::make_unique<JointStateController>(name, type, std::move(config));
}

const RegisterController kType(kJointStateType, make);

}  // namespace

JointStateConfig jointStatesOf(const ControllerKeys& keys, const RobotModel& model) {
  JointStateConfig config{keys.publish_rate, {}};
  for (const ExtraJoint& joint : keys.extra_joints) {
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
    if (aras_visual_servo_common::nameIn(item.second["type"]) != kJointStateType) continue;
    const std::string name = aras_visual_servo_common::nameIn(item.first);
    return jointStatesOf(readSection<ControllerKeys>(item.second, name, [](auto&&...) {}), model);
  }
  return {};
}

}  // namespace aras_visual_servo_sim
