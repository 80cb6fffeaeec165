#pragma once

#include <aras_visual_servo_common/yaml_reader.hpp>

#include "aras_visual_servo_camera/config/tag_config.hpp"

namespace aras_visual_servo_camera {

/** The section `tag`, open in a reader that is finished by the caller. */
TagConfig readTag(aras_visual_servo_common::YamlReader reader);

}  // namespace aras_visual_servo_camera
