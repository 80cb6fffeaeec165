#pragma once

#include <optional>
#include <string>

#include "aras_visual_servo_sim/config/types.hpp"

namespace aras_visual_servo_sim {

/** Diffuse colour of a material that comes with Gazebo, by its name ("Gazebo/Orange"); nothing for those that are
 *  pictures or transparent, and for unknown names. Source: Gazebo's media/materials/scripts/gazebo.material. */
std::optional<Rgba> gazeboColor(const std::string& material);

}  // namespace aras_visual_servo_sim
