#pragma once

#include <aras_visual_servo_common/yaml_reader.hpp>

#include "aras_visual_servo_camera/config/matching_config.hpp"

namespace aras_visual_servo_camera {

/** The section `matches`, open in a reader that is finished by the caller. */
MatchingConfig readMatching(aras_visual_servo_common::YamlReader reader);

}  // namespace aras_visual_servo_camera
