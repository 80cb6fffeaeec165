#include "aras_visual_servo_sim/physics/joint_controller.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "aras_visual_servo_sim/config/section.hpp"
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

bool hasPid(ControllerType type) {
  return type == ControllerType::kEffortPosition || type == ControllerType::kEffortVelocity;
}

const char* interfaceOf(ControllerType type) {
  if (type == ControllerType::kPosition) return "PositionJointInterface";
  return type == ControllerType::kVelocity ? "VelocityJointInterface" : "EffortJointInterface";
}

void readJoint(YamlReader& reader, const RobotModel& model, std::map<std::string, std::string>& users,
               ControllerConfig& config) {
  config.joint = reader.get<std::string>("joint");
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

/** control_toolbox::Pid::init: the signs of the clamps do not matter. */
PidGains readGains(YamlReader reader) {
  PidGains gains;
  reader.get<bool>("publish_state");  // checked; only a controller of one joint has such a topic
  gains.p = reader.get<double>("p");
  gains.i = reader.get<double>("i");
  gains.d = reader.get<double>("d");
  const double clamp = reader.get<double>("i_clamp");
  gains.i_min = -std::abs(reader.find<double>("i_clamp_min").value_or(clamp));
  gains.i_max = std::abs(reader.find<double>("i_clamp_max").value_or(clamp));
  gains.antiwindup = reader.get<bool>("antiwindup");
  return gains;
}

std::string controllerTypeName(ControllerType type) {
  for (const auto& known : knownTypes()) {
    if (known.second == type) return known.first;
  }
  return "unknown";
}

void checkGains(const PidGains& gains, const std::string& controller_name) {
  FaultList faults;
  static const auto section =  // to find it takes longer than all checks
      sectionOf("controller")
          .property(YAML::Load("{type: " + controllerTypeName(ControllerType::kEffortPosition) + "}"), "pid");
  checkValue(*section, "p", gains.p, faults);
  checkValue(*section, "i", gains.i, faults);
  checkValue(*section, "d", gains.d, faults);
  if (!(gains.i_min <= 0.0) || !std::isfinite(gains.i_min))
    faults.add("i_clamp_min", std::to_string(gains.i_min), "<= 0");
  if (!(gains.i_max >= 0.0) || !std::isfinite(gains.i_max))
    faults.add("i_clamp_max", std::to_string(gains.i_max), ">= 0");
  if (faults.empty()) return;
  FaultList named;
  named.adopt(ParameterError(faults.lines()), controller_name + "/pid/");
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
    YamlReader reader(item.second, sectionOf("controller"), config.name);
    const std::string type = reader.find<std::string>("type").value_or("");
    for (const auto& known : knownTypes()) {
      if (known.first != type) continue;
      config.type = known.second;
      readJoint(reader, model, users, config);
      config.command_timeout_s = reader.get<double>("command_timeout_s");
      if (hasPid(config.type)) {
        YamlReader pid = reader.section("pid");
        config.gains = readGains(pid);
        config.publish_state = pid.get<bool>("publish_state");
      }
      configs.push_back(config);
    }
    if (type == kJointStateType) readJointStates(reader, model);
    faults.collect([&] { reader.finish(); });
  }
  faults.throwIfAny();
  return configs;
}

}  // namespace aras_visual_servo_sim
