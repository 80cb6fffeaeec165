#pragma once

#include <ros/node_handle.h>
#include <visualization_msgs/MarkerArray.h>

#include "aras_visual_servo_sim/simulation/simulation.hpp"

namespace aras_visual_servo_sim {

/** The models of a simulation for rviz, flat ones and solids; links of the robot are rviz's own RobotModel. Solids have
 *  their colours, no pictures. In the frame `world`. */
visualization_msgs::MarkerArray sceneMarkers(const Simulation& simulation);

/** Latched topic `scene_markers`. */
class SceneMarkers {
 public:
  SceneMarkers(ros::NodeHandle& node, const Simulation& simulation);
  void publish();
  /** The same, if there are subscribers: for what changes often. */
  void refresh();

 private:
  const Simulation& simulation_;
  ros::Publisher publisher_;
};

}  // namespace aras_visual_servo_sim
