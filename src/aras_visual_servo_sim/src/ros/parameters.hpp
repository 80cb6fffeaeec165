#pragma once

#include <ros/node_handle.h>
#include <yaml-cpp/yaml.h>

#include "aras_visual_servo_sim/robot_model.hpp"
#include "aras_visual_servo_sim/simulation_config.hpp"

namespace aras_visual_servo_sim {

/** Everything the node reads from the parameter server, parsed. */
struct NodeParameters {
  RobotModel robot;
  SimulationConfig simulation;
  TimeConfig time;
  YAML::Node controllers;  ///< every map of the namespace whose `type` ends in "Controller"
  bool gazebo_names = false;
};

/** Reads `robot_description` (searched upwards), the controllers of the namespace, and of the private namespace the
 *  sections `sim` and `time`, which may also stand under `scenario/` there or in the namespace, and `gazebo_names`.
 *  @throws ParameterError listing every fault of all of them */
NodeParameters loadParameters(const ros::NodeHandle& node, const ros::NodeHandle& private_node);

}  // namespace aras_visual_servo_sim
