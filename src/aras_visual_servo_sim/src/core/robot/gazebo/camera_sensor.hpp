#pragma once

#include "aras_visual_servo_sim/robot/robot_model.hpp"
#include "robot/urdf_check.hpp"

namespace aras_visual_servo_sim {

/** Whether a <sensor type="wideanglecamera"> has the one <lens> type there is here; warns if not. */
bool hasEquidistantLens(const UrdfSource& source, const tinyxml2::XMLElement& sensor);

/** Reads a <sensor type="camera"> or "wideanglecamera" and its plugin (libgazebo_ros_camera.so,
 * libgazebo_ros_triggered_camera.so). Tags that are not read become warnings, but for those without a meaning here
 * (always_on, visualize, alwaysOn, save).
 *  @param link  the <gazebo reference>
 *  @throws ModelError naming file and line of a malformed number */
CameraTag readCameraSensor(const UrdfSource& source, const tinyxml2::XMLElement& sensor, const std::string& link);

}  // namespace aras_visual_servo_sim
