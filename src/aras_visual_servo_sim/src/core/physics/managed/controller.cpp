#include "aras_visual_servo_sim/physics/managed/controller.hpp"

#include <algorithm>
#include <map>
#include <utility>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "aras_visual_servo_sim/config/section.hpp"

namespace aras_visual_servo_sim {
namespace {

/** Filled before main() by the files of the controllers, whatever their order. */
std::map<std::string, MakeController>& registry() {
  static std::map<std::string, MakeController> types;
  return types;
}

}  // namespace

Controller::Controller(std::string name, std::string type, std::vector<ControllerConfig> drives)
    : name_(std::move(name)), type_(std::move(type)), drives_(std::move(drives)) {}

std::string Controller::hardwareInterface() const {
  return std::string("hardware_interface::") +
         (drives_.empty() ? "JointStateInterface" : interfaceOf(drives_.front().type));
}

RegisterController::RegisterController(const char* type, MakeController make) { registry()[type] = make; }

std::vector<std::string> controllerTypes() {
  std::vector<std::string> types;
  for (const auto& entry : registry()) types.push_back(entry.first);
  return types;
}

std::unique_ptr<Controller> makeController(const std::string& name, const YAML::Node& parameters,
                                           const RobotModel& model, std::vector<std::string>& warnings) {
  if (!parameters.IsDefined() || !parameters.IsMap() || !parameters["type"].IsDefined()) {
    throw ParameterError("controller '" + name + "': found no parameter '" + name +
                         "/type', allowed is one that was loaded, for example with rosparam");
  }
  const YAML::Node type = parameters["type"];
  const auto found = type.IsScalar() ? registry().find(type.Scalar()) : registry().end();
  if (found == registry().end()) {
    throw ParameterError("controller '" + name + "': found type " + YAML::Dump(type) + ", allowed is one of " +
                         joined(controllerTypes()));
  }
  return found->second(name, found->first, parameters, model, warnings);
}

YAML::Node describedKeys(const YAML::Node& map, const Schema& section, const std::string& where,
                         std::vector<std::string>& warnings) {
  YAML::Node kept(YAML::NodeType::Map);
  for (const auto& item : map) {
    const std::string key = aras_visual_servo_common::nameIn(item.first);
    if (section.property(map, key)) {
      kept[key] = item.second;
    } else {
      warnings.push_back(where + "/" + key + ": ignored, this type of controller has no such parameter");
    }
  }
  return kept;
}

void checkJoint(const RobotModel& model, const std::string& joint, ControllerType drive, const std::string& controller,
                FaultList& faults) {
  const auto at = std::find(model.joint_names.begin(), model.joint_names.end(), joint);
  if (at == model.joint_names.end()) {
    return faults.add(controller, "joint '" + joint + "'", "a joint that moves: " + joined(model.joint_names));
  }
  const Joint& found = model.movingJoint(static_cast<int>(at - model.joint_names.begin()));
  if (found.mimic.joint >= 0) {
    return faults.add(controller, "joint '" + joint + "', which mimics another",
                      "the joint that it follows, '" + model.joints[found.mimic.joint].name + "'");
  }
  const auto& interfaces = found.hardware_interfaces;
  if (std::find(interfaces.begin(), interfaces.end(), interfaceOf(drive)) != interfaces.end()) return;
  faults.add(controller + ": could not find joint '" + joint + "' in 'hardware_interface::" + interfaceOf(drive) +
             "': its <transmission> says " + (interfaces.empty() ? "nothing" : joined(interfaces)));
}

std::string interfaceOfType(const std::string& type) {
  const std::string package = type.substr(0, type.find('/'));
  if (package.compare(0, 8, "position") == 0 || package.compare(0, 7, "pos_vel") == 0) return "Position";
  return package.compare(0, 8, "velocity") == 0 ? "Velocity" : "Effort";
}

}  // namespace aras_visual_servo_sim
