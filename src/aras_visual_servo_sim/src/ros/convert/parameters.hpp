#pragma once

#include <ros/node_handle.h>
#include <yaml-cpp/yaml.h>

#include "aras_visual_servo_sim/physics/managed/joint_state_controller.hpp"
#include "aras_visual_servo_sim/robot/robot_model.hpp"
#include "aras_visual_servo_sim/simulation/simulation_config.hpp"
#include "aras_visual_servo_sim/simulation/time/time_config.hpp"

namespace aras_visual_servo_sim {

/** Private parameter that the node itself sets; one that is there at the start is a predecessor's. */
constexpr char kSegmentationIds[] = "segmentation_ids";

/** Everything the node reads from the parameter server, parsed. */
struct NodeParameters {
  RobotModel robot;
  SimulationConfig simulation;
  TimeConfig time;
  YAML::Node controllers;  ///< every map of the namespace whose `type` ends in "Controller"
  JointStateConfig joint_states;
  NodeConfig own;  ///< the private parameters of the node itself
};

/** Reads `robot_description` (searched upwards), the controllers of the namespace, and of the private namespace the
 *  sections `sim` and `time`, which may also stand under `scenario/` there or in the namespace, `gazebo_names`,
 *  `gazebo_camera_names`, `base_tf`, `link_tf`, `nodelets` and `nodelet_threads`.
 *  @throws ParameterError listing every fault of all of them */
NodeParameters loadParameters(const ros::NodeHandle& node, const ros::NodeHandle& private_node);

/** What the node can take over while it runs, of the sections `sim` and `time` as they are on the parameter server now.
 *  @param started  the section `sim` that the node started with, from `simSection`
 *  @throws ParameterError: a fault of them, or `sim` differs from `started` in something that needs a new start */
struct LiveParameters {
  SimulationConfig simulation;
  double real_time_factor = 0.0;
  bool cameras = false, lighting = false;  ///< whether they differ from those of `before`
};
LiveParameters loadLiveParameters(const ros::NodeHandle& node, const ros::NodeHandle& private_node,
                                  const YAML::Node& before);

/** The section `sim` as it is on the parameter server. */
YAML::Node simSection(const ros::NodeHandle& node, const ros::NodeHandle& private_node);

}  // namespace aras_visual_servo_sim
