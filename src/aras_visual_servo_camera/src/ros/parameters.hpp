#pragma once

#include <ros/node_handle.h>

#include "aras_visual_servo_camera/config/vision_config.hpp"

namespace aras_visual_servo_camera {

/** The vision section: `~vision`, else `~scenario/vision`, else `scenario/vision` of the namespace.
 *  @throws ParameterError if none is there, or listing all its faults */
VisionConfig readParameters(const ros::NodeHandle& node, const ros::NodeHandle& private_node);

}  // namespace aras_visual_servo_camera
