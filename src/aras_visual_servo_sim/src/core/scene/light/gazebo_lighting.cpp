// What a Gazebo world with its model "sun" is lit by.
#include <cmath>

#include "aras_visual_servo_sim/scene/scene_config.hpp"

namespace aras_visual_servo_sim {

void SceneConfig::lightAsGazebo() {
  constexpr double kAmbient = 0.4, kBackground = 0.7, kDiffuse = 0.8, kSpecular = 0.1;
  if (!has_background) {
    const auto grey = static_cast<std::uint8_t>(std::lround(255.0 * kBackground));
    background = {grey, grey, grey};
  }
  lighting.as_coverage = false;
  if (has_lights) return;
  Light sun;
  sun.name = "sun";
  sun.direction_W = {-0.5, 0.5, -1.0};
  sun.diffuse.setConstant(kDiffuse);
  sun.specular.setConstant(kSpecular);
  lighting.ambient.setConstant(kAmbient);
  lighting.lights = {sun};
}

}  // namespace aras_visual_servo_sim
