// Controllers that pass on what they are told: those of one joint, and groups of joints with one list of commands.
#include <string>
#include <utility>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "aras_visual_servo_sim/config/section.hpp"
#include "aras_visual_servo_sim/physics/managed/controller.hpp"

namespace aras_visual_servo_sim {
namespace {

using Drives = std::vector<ControllerConfig>;

std::unique_ptr<Controller> makeSingle(const std::string& name, const std::string& type, const YAML::Node& parameters,
                                       const RobotModel& model, std::vector<std::string>& warnings) {
  YAML::Node entry;
  entry[name] = describedKeys(parameters, ControllerKeys::schema(), name, warnings);
  Drives drives = parseControllers(entry, model);
  FaultList faults;
  for (const ControllerConfig& drive : drives) checkJoint(model, drive.joint, drive.type, name, faults);
  faults.throwIfAny();
  return std::make_unique<Controller>(name, type, std::move(drives));
}

/** The drive of each joint of a group: of effort groups for positions a PID, else the command itself. */
ControllerType driveOfGroup(const std::string& type) {
  const std::string interface = interfaceOfType(type);
  if (interface == "Position") return ControllerType::kPosition;
  if (interface == "Velocity") return ControllerType::kVelocity;
  return type.find("Position") != std::string::npos ? ControllerType::kEffortPosition : ControllerType::kEffort;
}

std::unique_ptr<Controller> makeGroup(const std::string& name, const std::string& type, const YAML::Node& parameters,
                                      const RobotModel& model, std::vector<std::string>& warnings) {
  Drives drives;
  const auto add = [&](const auto& settings, const SectionCheck& section) {
    for (const std::string& joint : settings.joints) {
      ControllerConfig drive;
      drive.name = name + "/" + joint;
      drive.type = driveOfGroup(type);
      drive.joint = joint;
      checkJoint(model, joint, drive.type, name, section.faults());
      drives.push_back(std::move(drive));
    }
  };
  if (driveOfGroup(type) != ControllerType::kEffortPosition) {
    readController<GroupControllerConfig>(parameters, name, warnings, add);
  } else {
    readController<GroupPidControllerConfig>(
        parameters, name, warnings, [&](const GroupPidControllerConfig& settings, const SectionCheck& section) {
          add(settings, section);
          for (ControllerConfig& drive : drives) {
            const auto found = settings.others.find(drive.joint);
            if (found == settings.others.end()) {
              section.faults().add(name, "no " + drive.joint + "/pid", "gains for each joint");
            } else if (!found->second.pid) {
              section.part(drive.joint).missing("pid", "a map (required)");
            } else {
              drive.gains = gainsOf(*found->second.pid);
            }
          }
        });
  }
  return std::make_unique<Controller>(name, type, std::move(drives));
}

const RegisterController kTypes[] = {{"effort_controllers/JointEffortController", makeSingle},
                                     {"effort_controllers/JointPositionController", makeSingle},
                                     {"effort_controllers/JointVelocityController", makeSingle},
                                     {"position_controllers/JointPositionController", makeSingle},
                                     {"velocity_controllers/JointVelocityController", makeSingle},
                                     {"effort_controllers/JointGroupEffortController", makeGroup},
                                     {"effort_controllers/JointGroupPositionController", makeGroup},
                                     {"position_controllers/JointGroupPositionController", makeGroup},
                                     {"velocity_controllers/JointGroupVelocityController", makeGroup}};

}  // namespace
}  // namespace aras_visual_servo_sim
