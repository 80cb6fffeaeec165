#pragma once

#include <optional>
#include <string>

#include "aras_visual_servo_sim/config/types.hpp"
#include "aras_visual_servo_sim/robot/robot_model.hpp"

namespace aras_visual_servo_sim {

/** A material that comes with Gazebo. */
struct GazeboMaterial {
  Rgba diffuse;
  Finish finish;
};

/** By its name ("Gazebo/Orange"); nothing for those that are pictures or transparent, and for unknown names. Source:
 *  Gazebo's media/materials/scripts/gazebo.material. */
std::optional<GazeboMaterial> gazeboMaterial(const std::string& material);

}  // namespace aras_visual_servo_sim
