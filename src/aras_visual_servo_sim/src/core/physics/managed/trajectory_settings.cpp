// The parameters of a TrajectoryController, and the types that it is known by.
#include <string>
#include <utility>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "aras_visual_servo_sim/config/section.hpp"
#include "aras_visual_servo_sim/physics/managed/trajectory_controller.hpp"

namespace aras_visual_servo_sim {
namespace {

ControllerType driveOf(const std::string& type) {
  const std::string interface = interfaceOfType(type);
  if (interface == "Position") return ControllerType::kPosition;
  return interface == "Velocity" ? ControllerType::kVelocity : ControllerType::kEffortPosition;
}

std::unique_ptr<Controller> make(const std::string& name, const std::string& type, const YAML::Node& parameters,
                                 const RobotModel& model, std::vector<std::string>& warnings) {
  const Schema& section = sectionOf("trajectory_controller");
  YamlReader reader(describedKeys(parameters, section, name, warnings), section, name);
  reader.get<std::string>("type");
  TrajectoryController::Settings settings;
  std::vector<ControllerConfig> drives;
  YamlReader constraints = reader.section("constraints"), gains = reader.section("gains"),
             forward = reader.section("velocity_ff");
  const double stopped = constraints.get<double>("stopped_velocity_tolerance");
  settings.goal_time_s = constraints.get<double>("goal_time");
  settings.stop_duration_s = reader.get<double>("stop_trajectory_duration");
  settings.state_rate_hz = reader.get<double>("state_publish_rate");
  settings.monitor_rate_hz = reader.get<double>("action_monitor_rate");
  settings.partial_joints = reader.get<bool>("allow_partial_joints_goal");
  for (const std::string& joint : reader.get<std::vector<std::string>>("joints")) {
    ControllerConfig drive;
    drive.name = name + "/gains/" + joint;
    drive.type = driveOf(type);
    drive.joint = joint;
    checkJoint(model, joint, drive.type, name, reader.faults());
    if (drive.type != ControllerType::kPosition) {
      if (gains.has(joint)) {
        drive.gains = readGains(gains.section(joint));
      } else {
        warnings.push_back(name + "/gains/" + joint + ": is missing, so this joint follows nothing");
      }
    }
    if (reader.faults().empty()) {
      YamlReader limits = constraints.section(joint);
      settings.path.push_back({limits.get<double>("trajectory"), 0.0, 0.0});
      settings.goal.push_back({limits.get<double>("goal"), stopped, 0.0});
      settings.velocity_gain.push_back(forward.find<double>(joint).value_or(0.0));
      settings.continuous.push_back(model.movingJoint(model.jointIndex(joint)).type == JointType::kContinuous);
    }
    drives.push_back(std::move(drive));
  }
  reader.finish();
  return std::make_unique<TrajectoryController>(name, type, std::move(drives), std::move(settings));
}

const RegisterController kTypes[] = {{"effort_controllers/JointTrajectoryController", make},
                                     {"position_controllers/JointTrajectoryController", make},
                                     {"velocity_controllers/JointTrajectoryController", make},
                                     {"pos_vel_controllers/JointTrajectoryController", make}};

}  // namespace
}  // namespace aras_visual_servo_sim
