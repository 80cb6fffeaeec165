#pragma once

#include <yaml-cpp/yaml.h>

#include <optional>
#include <string>
#include <vector>

#include "aras_visual_servo_sim/config/section.hpp"
#include "aras_visual_servo_sim/robot/robot_model.hpp"

namespace aras_visual_servo_sim {

/** Its type among ros_control's controllers. */
inline const char kJointStateType[] = "joint_state_controller/JointStateController";

/** Settings of ros_control's joint_state_controller/JointStateController. */
struct JointStateConfig {
  std::optional<double> publish_rate_hz;  ///< > 0
  std::vector<ExtraJoint> extra_joints;   ///< in the order of the file; those that the robot has are ignored
};

/** The settings that the keys of a controller of that type give. */
JointStateConfig jointStatesOf(const ControllerKeys& keys, const RobotModel& model);

/** The joint state controller among ros_control's controllers (parseControllers), the first if there are several.
 *  @throws ParameterError listing every fault of it */
JointStateConfig parseJointStates(const YAML::Node& controllers, const RobotModel& model);

}  // namespace aras_visual_servo_sim
