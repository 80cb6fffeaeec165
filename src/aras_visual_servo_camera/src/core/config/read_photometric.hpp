#pragma once

#include <aras_visual_servo_common/yaml_reader.hpp>

#include "aras_visual_servo_camera/config/photometric_config.hpp"

namespace aras_visual_servo_camera {

/** The section `photometric`, open in a reader that is finished by the caller. */
PhotometricConfig readPhotometric(aras_visual_servo_common::YamlReader reader);

}  // namespace aras_visual_servo_camera
