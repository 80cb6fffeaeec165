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
  std::vector<ControllerConfig> drives;
  const auto keys = readController<TrajectoryControllerConfig>(
      parameters, name, warnings, [&](const TrajectoryControllerConfig& given, const SectionCheck& section) {
        for (const std::string& joint : given.joints) {
          ControllerConfig drive;
          drive.name = name + "/gains/" + joint;
          drive.type = driveOf(type);
          drive.joint = joint;
          checkJoint(model, joint, drive.type, name, section.faults());
          drives.push_back(std::move(drive));
        }
      });
  TrajectoryController::Settings settings;
  settings.goal_time_s = keys.constraints.goal_time;
  settings.stop_duration_s = keys.stop_trajectory_duration;
  settings.state_rate_hz = keys.state_publish_rate;
  settings.monitor_rate_hz = keys.action_monitor_rate;
  settings.partial_joints = keys.allow_partial_joints_goal;
  for (ControllerConfig& drive : drives) {
    const std::string& joint = drive.joint;
    if (drive.type != ControllerType::kPosition) {
      if (const auto gains = keys.gains.find(joint); gains != keys.gains.end()) {
        drive.gains = gainsOf(gains->second);
      } else {
        warnings.push_back(drive.name + ": is missing, so this joint follows nothing");
      }
    }
    const auto found = keys.constraints.others.find(joint);
    const JointConstraints limits = found == keys.constraints.others.end() ? JointConstraints() : found->second;
    const auto forward = keys.velocity_ff.find(joint);
    settings.path.push_back({limits.trajectory, 0.0, 0.0});
    settings.goal.push_back({limits.goal, keys.constraints.stopped_velocity_tolerance, 0.0});
    settings.velocity_gain.push_back(forward == keys.velocity_ff.end() ? 0.0 : forward->second);
    settings.continuous.push_back(model.movingJoint(model.jointIndex(joint)).type == JointType::kContinuous);
  }
  return std::make_unique<TrajectoryController>(name, type, std::move(drives), std::move(settings));
}

const RegisterController kTypes[] = {{"effort_controllers/JointTrajectoryController", make},
                                     {"position_controllers/JointTrajectoryController", make},
                                     {"velocity_controllers/JointTrajectoryController", make},
                                     {"pos_vel_controllers/JointTrajectoryController", make}};

}  // namespace
}  // namespace aras_visual_servo_sim
