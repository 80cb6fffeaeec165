#pragma once

#include "aras_visual_servo_sim/config/section.hpp"
#include "aras_visual_servo_sim/scene/lighting.hpp"

namespace aras_visual_servo_sim {

/** A colour of red, green and blue, 0 .. 255, rounded to bytes. */
Rgb colorOf(const Eigen::Vector3d& rgb);

/** What sections give, and what their schemas cannot express. */
Light lightOf(const LightConfig& settings);
void checkLight(const LightConfig& settings, const SectionCheck& section);
Lighting lightingOf(const LightingConfig& settings);
Material materialOf(const MaterialConfig& settings);

}  // namespace aras_visual_servo_sim
