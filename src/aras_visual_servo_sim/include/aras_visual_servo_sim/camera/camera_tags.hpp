#pragma once

#include <string>
#include <vector>

#include "aras_visual_servo_sim/camera/camera_config.hpp"
#include "aras_visual_servo_sim/robot/robot_model.hpp"

namespace aras_visual_servo_sim {

/** Cameras described by <gazebo> sensor tags of a URDF, for simulations whose configuration has none.
 *
 *  camera_info is what Gazebo's plugin publishes where the tags say so (focalLength, Cx, Cy, distortionK1 ...,
 * hackBaseline), and the image always agrees with it; where Gazebo's own image would not, there is a warning.
 *  @param as_gazebo  camera_info is Gazebo's even where Gazebo's image is not drawn with it, and so is the image: the
 *                    principal point told is (w + 1) / 2 without Cx, the one drawn with (w - 1) / 2; focalLength, Cx,
 * Cy and the plugin's distortion are told and not drawn
 *  @param warnings  gets a line for each thing that Gazebo does otherwise, or where image and camera_info disagree
 *  @throws ModelError for an unknown image format */
std::vector<CameraConfig> camerasFromTags(const RobotModel& model, std::vector<std::string>& warnings,
                                          bool as_gazebo = false);

}  // namespace aras_visual_servo_sim
