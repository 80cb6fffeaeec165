#pragma once

#include "aras_visual_servo_camera/config/sections.hpp"

namespace aras_visual_servo_camera {

/** Reads the section `vision` of a scenario, or one of its sections.
 *  @throws ParameterError listing every fault of the section */
VisionConfig readVisionConfig(const YAML::Node& node);
PhotometricConfig readPhotometricConfig(const YAML::Node& node);
MatchingConfig readMatchingConfig(const YAML::Node& node);
TagConfig readTagConfig(const YAML::Node& node);

}  // namespace aras_visual_servo_camera
