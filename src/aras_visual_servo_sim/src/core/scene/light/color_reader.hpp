#pragma once

#include <Eigen/Core>
#include <string>

#include "aras_visual_servo_sim/config/section.hpp"
#include "aras_visual_servo_sim/image/image.hpp"

namespace aras_visual_servo_sim {

/** Of red, green and blue, 0 .. 255, rounded to bytes. */
Rgb colorOf(const Eigen::Vector3d& rgb);
/** A colour of three numbers, section `color`. */
Rgb readColor(YamlReader& reader, const std::string& key);

}  // namespace aras_visual_servo_sim
