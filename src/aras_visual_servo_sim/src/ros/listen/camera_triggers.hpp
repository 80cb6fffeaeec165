#pragma once

#include <ros/node_handle.h>
#include <ros/subscriber.h>

#include <vector>

#include "aras_visual_servo_sim/simulation/simulation.hpp"
#include "publish/camera_topics.hpp"

namespace aras_visual_servo_sim {

/** Takes std_msgs/Empty on <camera>/image_trigger of every triggered camera, as gazebo_ros_triggered_camera does; the
 *  plugin's <triggerTopicName> is the topic's name where the URDF has that camera. */
class CameraTriggers {
 public:
  CameraTriggers(ros::NodeHandle& node, Simulation& simulation, const std::vector<CameraTopics>& topics);

 private:
  std::vector<ros::Subscriber> subscribers_;
};

}  // namespace aras_visual_servo_sim
