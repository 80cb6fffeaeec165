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

/** A joint that is not simulated. It is published with the others, in a constant state [m or rad, per s, N or N m]. */
struct ExtraJoint {
  std::string name;
  double position = 0.0, velocity = 0.0, effort = 0.0;
};

/** Settings of ros_control's joint_state_controller/JointStateController. */
struct JointStateConfig {
  std::optional<double> publish_rate_hz;  ///< > 0
  std::vector<ExtraJoint> extra_joints;   ///< in the order of the file; those that the robot has are ignored
};

/** Reads the keys of a controller of that type. Faults go to the reader. */
JointStateConfig readJointStates(YamlReader& reader, const RobotModel& model);

/** The joint state controller among ros_control's controllers (parseControllers), the first if there are several.
 *  @throws ParameterError listing every fault of it */
JointStateConfig parseJointStates(const YAML::Node& controllers, const RobotModel& model);

}  // namespace aras_visual_servo_sim
