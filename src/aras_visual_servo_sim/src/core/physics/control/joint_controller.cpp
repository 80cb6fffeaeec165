#include "aras_visual_servo_sim/physics/joint_controller.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "aras_visual_servo_sim/config/yaml_reader.hpp"
#include "aras_visual_servo_sim/physics/joint_state_config.hpp"

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

const char kJointState[] = "joint_state_controller/JointStateController";

/** control_toolbox::Pid::init: only p is required; the signs of the clamps do not matter. */
PidGains readGains(YamlReader reader, bool& publish_state) {
  PidGains gains;
  gains.p = reader.required<double>("p", Range::nonNegative());
  gains.i = reader.optional<double>("i", 0.0, Range::nonNegative());
  gains.d = reader.optional<double>("d", 0.0, Range::nonNegative());
  const double clamp = std::abs(reader.optional<double>("i_clamp", 0.0));
  gains.i_min = -std::abs(reader.optional<double>("i_clamp_min", clamp));
  gains.i_max = std::abs(reader.optional<double>("i_clamp_max", clamp));
  gains.antiwindup = reader.optional<bool>("antiwindup", false);
  publish_state = reader.optional<bool>("publish_state", false);
  return gains;
}

const char* interfaceOf(ControllerType type) {
  if (type == ControllerType::kPosition) return "PositionJointInterface";
  return type == ControllerType::kVelocity ? "VelocityJointInterface" : "EffortJointInterface";
}

void readJoint(YamlReader& reader, const RobotModel& model, std::map<std::string, std::string>& users,
               ControllerConfig& config) {
  config.joint = reader.required<std::string>("joint");
  if (config.joint.empty()) return;
  try {
    model.jointIndex(config.joint);
  } catch (const UnknownNameError& error) {
    std::string known;
    for (const auto& name : model.joint_names) known += (known.empty() ? "" : ", ") + name;
    reader.fault("joint", config.joint, "a moving joint: " + known);
    return;
  }
  const auto inserted = users.emplace(config.joint, config.name);
  const auto& interfaces = model.movingJoint(model.jointIndex(config.joint)).hardware_interfaces;
  const std::string needed = interfaceOf(config.type);
  if (!interfaces.empty() && std::find(interfaces.begin(), interfaces.end(), needed) == interfaces.end()) {
    reader.fault("type", controllerTypeName(config.type) + " (" + needed + ")",
                 "one for " + interfaces.front() + ", the hardware interface of the <transmission> of joint '" +
                     config.joint + "'");
  }
  if (!inserted.second) {
    reader.fault("joint", config.joint, "a joint no other controller has (" + inserted.first->second + " has it)");
  }
}

}  // namespace

std::string controllerTypeName(ControllerType type) {
  for (const auto& known : knownTypes()) {
    if (known.second == type) return known.first;
  }
  return "unknown";
}

void checkGains(const PidGains& gains, const std::string& controller_name) {
  std::string faults;
  const auto check = [&](const char* key, double value, bool good, const char* allowed) {
    if (std::isfinite(value) && good) return;
    faults += (faults.empty() ? "" : "\n") + controller_name + "/pid/" + key + ": found " + std::to_string(value) +
              ", allowed " + allowed;
  };
  check("p", gains.p, gains.p >= 0.0, ">= 0");
  check("i", gains.i, gains.i >= 0.0, ">= 0");
  check("d", gains.d, gains.d >= 0.0, ">= 0");
  check("i_clamp_min", gains.i_min, gains.i_min <= 0.0, "<= 0");
  check("i_clamp_max", gains.i_max, gains.i_max >= 0.0, ">= 0");
  if (!faults.empty()) throw ParameterError(faults);
}

std::vector<ControllerConfig> parseControllers(const YAML::Node& node, const RobotModel& model) {
  std::vector<ControllerConfig> configs;
  if (node.IsDefined() && !node.IsNull() && !node.IsMap()) {
    throw ParameterError("controllers: found " + YAML::Dump(node) + ", allowed a map of controllers by name");
  }
  std::map<std::string, std::string> users;
  std::string faults;
  for (const auto& item : node) {
    if (!item.second.IsMap() || !item.second["type"].IsDefined()) continue;
    ControllerConfig config;
    config.name = item.first.as<std::string>();
    YamlReader reader(item.second, config.name);
    std::vector<std::string> names = {kJointState};
    for (const auto& known : knownTypes()) names.push_back(known.first);
    const std::string type = reader.requiredChoice("type", names);
    if (type == kJointState) {
      readJointStates(reader, model);
    } else {
      for (const auto& known : knownTypes()) {
        if (known.first == type) config.type = known.second;
      }
      readJoint(reader, model, users, config);
      config.command_timeout_s = reader.optional<double>("command_timeout_s", 0.0, Range::nonNegative());
      const bool has_pid =
          config.type == ControllerType::kEffortPosition || config.type == ControllerType::kEffortVelocity;
      if (has_pid) {
        config.gains = readGains(reader.section("pid", true), config.publish_state);
      } else {
        reader.raw("pid");
      }
    }
    try {
      reader.finish();
    } catch (const ParameterError& error) {
      faults += (faults.empty() ? "" : "\n") + std::string(error.what());
    }
    if (type != kJointState) configs.push_back(config);
  }
  if (!faults.empty()) throw ParameterError(faults);
  return configs;
}

}  // namespace aras_visual_servo_sim
