#pragma once

#include <string>

#include "aras_visual_servo_sim/config/types.hpp"

namespace aras_visual_servo_sim {

/** Checks a pose that somebody asks for: its position as the section solid has it, its quaternion of a length that can
 * be made 1. @param what  names it in messages @throws NotFiniteError, ParameterError */
void checkPlace(const std::string& what, const Pose& pose);

}  // namespace aras_visual_servo_sim
