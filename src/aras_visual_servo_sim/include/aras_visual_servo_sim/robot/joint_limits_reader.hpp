#pragma once

#include <yaml-cpp/yaml.h>

#include "aras_visual_servo_sim/robot/robot_model.hpp"

namespace aras_visual_servo_sim {

/** Overrides Joint::enforced and Joint::soft by the entry `joint_limits` of the same map, joint by joint, as
 *  joint_limits_interface::getJointLimits and getSoftJointLimits do from the parameter server. What they ignore
 *  silently (an incomplete limit, an unknown joint, jerk) becomes a warning of the model.
 *  @throws ParameterError with all faults: unknown keys, wrong types, limits that exclude each other */
void applyJointLimits(const YAML::Node& node, RobotModel& model);

}  // namespace aras_visual_servo_sim
