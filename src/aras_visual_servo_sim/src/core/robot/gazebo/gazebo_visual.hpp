#pragma once

#include <tinyxml2.h>

#include "aras_visual_servo_sim/robot/robot_model.hpp"
#include "gazebo_materials.hpp"
#include "robot/urdf_check.hpp"

namespace aras_visual_servo_sim {

/** Gives a visual a material in place of its own. */
void paint(const GazeboMaterial& material, Visual& visual);

/** Reads a <visual> of <gazebo reference="link">: how the visuals of that link look, or the one that its attribute
 * `name` names. Its elements material and transparency are used as SDF has them, others warned about; cast_shadows is
 * the business of whoever puts the link into a scene.
 *  @param robot  root of the document */
void readVisualTag(const UrdfSource& source, const tinyxml2::XMLElement& tag, const tinyxml2::XMLElement& robot,
                   Link& link);

}  // namespace aras_visual_servo_sim
