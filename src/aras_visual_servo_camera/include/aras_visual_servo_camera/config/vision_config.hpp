#pragma once

#include <variant>

#include "aras_visual_servo_camera/config/sections.hpp"

namespace aras_visual_servo_camera {

/** Reads the section `vision` of a scenario, or one of its sections.
 *  @throws ParameterError listing every fault of the section */
VisionConfig readVisionConfig(const YAML::Node& node);
PhotometricConfig readPhotometricConfig(const YAML::Node& node);
MatchingConfig readMatchingConfig(const YAML::Node& node);
TagConfig readTagConfig(const YAML::Node& node);

/** Whether the target is darker than what is around it; else it is brighter or has a colour. */
inline bool isDark(const VisionConfig& config) {
  const ObjectShade* shade = std::get_if<ObjectShade>(&config.object);
  return shade && *shade == ObjectShade::kDark;
}

}  // namespace aras_visual_servo_camera
