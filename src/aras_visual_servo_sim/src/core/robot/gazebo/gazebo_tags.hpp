#pragma once

#include <tinyxml2.h>

#include <optional>
#include <string>

#include "aras_visual_servo_sim/config/types.hpp"
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

/** A material that comes with Gazebo. */
struct GazeboMaterial {
  Rgba diffuse;
  Finish finish;
};

/** By its name ("Gazebo/Orange"); nothing for those that are pictures or transparent, and for unknown names. Source:
 *  Gazebo's media/materials/scripts/gazebo.material. */
std::optional<GazeboMaterial> gazeboMaterial(const std::string& material);

/** Gives a visual a material in place of its own. */
void paint(const GazeboMaterial& material, Visual& visual);

/** Reads a <visual> of <gazebo reference="link">: how the visuals of that link look, or the one that its attribute
 * `name` names. Its elements material and transparency are used as SDF has them, others warned about; cast_shadows is
 * the business of whoever puts the link into a scene.
 *  @param robot  root of the document */
void readVisualTag(const UrdfSource& source, const tinyxml2::XMLElement& tag, const tinyxml2::XMLElement& robot,
                   Link& link);

}  // namespace aras_visual_servo_sim
