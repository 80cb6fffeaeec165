#include <ros/ros.h>

#include "aras_visual_servo_camera/config/errors.hpp"
#include "camera_node.hpp"

int main(int argc, char** argv) {
  ros::init(argc, argv, "camera_node");
  ros::NodeHandle node, private_node("~");
  try {
    aras_visual_servo_camera::CameraNode camera(node, private_node);
    ros::spin();
  } catch (const aras_visual_servo_camera::ArasError& error) {
    ROS_FATAL_STREAM("camera_node cannot start:\n" << error.what());
    return 1;
  }
  return 0;
}
