#pragma once

#include <ros/node_handle.h>
#include <visualization_msgs/MarkerArray.h>

#include <string>

#include "aras_visual_servo_sim/scene.hpp"

namespace aras_visual_servo_sim {

/** The planar models of a scene for rviz; bodies of the robot are rviz's own RobotModel.
 *  @param world_frame  frame id of W */
visualization_msgs::MarkerArray sceneMarkers(const Scene& scene, const std::string& world_frame);

/** Latched topic `scene_markers`. */
class SceneMarkers {
 public:
  SceneMarkers(ros::NodeHandle& node, std::string world_frame);
  void publish(const Scene& scene);

 private:
  std::string world_frame_;
  ros::Publisher publisher_;
};

}  // namespace aras_visual_servo_sim
