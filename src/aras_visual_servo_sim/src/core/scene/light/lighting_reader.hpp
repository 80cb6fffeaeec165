#pragma once

#include "aras_visual_servo_sim/config/section.hpp"
#include "aras_visual_servo_sim/scene/lighting.hpp"

namespace aras_visual_servo_sim {

/** Section `light`. Faults go to reader. */
Light readLight(YamlReader& reader);
/** Section `lighting`. Faults go to reader. */
Lighting readLighting(YamlReader& reader);
/** Section `material`, but for casts_shadows. */
Material readMaterial(YamlReader& reader);

}  // namespace aras_visual_servo_sim
