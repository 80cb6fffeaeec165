#include "aras_visual_servo_sim/physics/joint_controller.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "aras_visual_servo_sim/config/section.hpp"

namespace aras_visual_servo_sim {

namespace {

const std::vector<std::pair<std::string, ControllerType>>& knownTypes() {
  static const std::vector<std::pair<std::string, ControllerType>> kTypes = {
      {"effort_controllers/JointPositionController", ControllerType::kEffortPosition},
      {"effort_controllers/JointVelocityController", ControllerType::kEffortVelocity},
      {"effort_controllers/JointEffortController", ControllerType::kEffort},
      {"position_controllers/JointPositionController", ControllerType::kPosition},
      {"velocity_controllers/JointVelocityController", ControllerType::kVelocity}};
  return kTypes;
}

void checkUse(const SectionCheck& section, const RobotModel& model, std::map<std::string, std::string>& users,
              const ControllerConfig& config) {
  if (config.joint.empty()) return;
  try {
    model.jointIndex(config.joint);
  } catch (const UnknownNameError& error) {
    return section.fault("joint", config.joint,
                         "a moving joint: " + aras_visual_servo_common::oneOf(model.joint_names, config.joint));
  }
  const auto inserted = users.emplace(config.joint, config.name);
  const auto& interfaces = model.movingJoint(model.jointIndex(config.joint)).hardware_interfaces;
  const std::string needed = interfaceOf(config.type);
  if (!interfaces.empty() && std::find(interfaces.begin(), interfaces.end(), needed) == interfaces.end()) {
    section.fault("type", controllerTypeName(config.type) + " (" + needed + ")",
                  "one for " + interfaces.front() + ", the hardware interface of the <transmission> of joint '" +
                      config.joint + "'");
  }
  if (!inserted.second) {
    section.fault("joint", config.joint, "a joint no other controller has (" + inserted.first->second + " has it)");
  }
}

}  // namespace

const char* interfaceOf(ControllerType type) {
  if (type == ControllerType::kPosition) return "PositionJointInterface";
  return type == ControllerType::kVelocity ? "VelocityJointInterface" : "EffortJointInterface";
}

/** control_toolbox::Pid::init: the signs of the clamps do not matter. */
PidGains gainsOf(const PidKeys& pid) {
  return {pid.p,
          pid.i,
          pid.d,
          -std::abs(pid.i_clamp_min.value_or(pid.i_clamp)),
          std::abs(pid.i_clamp_max.value_or(pid.i_clamp)),
          pid.antiwindup};
}

std::string controllerTypeName(ControllerType type) {
  for (const auto& known : knownTypes()) {
    if (known.second == type) return known.first;
  }
  return "unknown";
}

void checkGains(const PidGains& gains, const std::string& controller_name) {
  FaultList faults;
  for (const auto& [key, gain] : {std::pair{"p", gains.p}, std::pair{"i", gains.i}, std::pair{"d", gains.d}}) {
    checkValue(PidKeys::schema(), key, gain, faults);
  }
  if (!(gains.i_min <= 0.0) || !std::isfinite(gains.i_min))
    faults.add("i_clamp_min", std::to_string(gains.i_min), "<= 0");
  if (!(gains.i_max >= 0.0) || !std::isfinite(gains.i_max))
    faults.add("i_clamp_max", std::to_string(gains.i_max), ">= 0");
  if (faults.empty()) return;
  FaultList named;
  named.adopt(ParameterError(faults.lines()), controller_name + ".pid.");
  named.throwIfAny();
}

std::vector<ControllerConfig> parseControllers(const YAML::Node& node, const RobotModel& model) {
  if (node.IsDefined() && !node.IsNull() && !node.IsMap()) {
    throw ParameterError("controllers: found " + YAML::Dump(node) + ", allowed a map of controllers by name");
  }
  std::vector<ControllerConfig> configs;
  std::map<std::string, std::string> users;
  FaultList faults;
  for (const auto& item : node) {
    if (!item.second.IsMap() || !item.second["type"].IsDefined()) continue;
    ControllerConfig config;
    config.name = aras_visual_servo_common::nameIn(item.first);
    const auto keys = aras_visual_servo_common::readSettings<ControllerKeys>(item.second, ControllerKeys::schema(),
                                                                             config.name, faults);
    for (const auto& known : knownTypes()) {
      if (known.first != keys.type) continue;
      config.type = known.second;
      config.joint = keys.joint;
      config.command_timeout_s = keys.command_timeout_s;
      checkUse(SectionCheck(item.second, config.name, faults), model, users, config);
      if (hasPid(config.type)) {
        config.gains = gainsOf(keys.pid);
        config.publish_state = keys.pid.publish_state;
      }
      configs.push_back(config);
    }
  }
  faults.throwIfAny();
  return configs;
}

}  // namespace aras_visual_servo_sim
