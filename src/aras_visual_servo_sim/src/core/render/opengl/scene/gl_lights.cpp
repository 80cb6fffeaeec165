#include "gl_lights.hpp"

#include "aras_visual_servo_sim/config/errors.hpp"

namespace aras_visual_servo_sim {
namespace {

bool asksForShadow(const Light& light) { return light.casts_shadows && !light.at_camera; }

}  // namespace

LightSet::LightSet(const Scene& scene) : ambient(scene.lighting.ambient), lights(scene.lighting.lights) {
  if (lights.size() > Lighting::kMostLights) {
    throw RenderError("renderer 'opengl': found " + std::to_string(lights.size()) + " lights, allowed up to " +
                      std::to_string(Lighting::kMostLights));
  }
  if (scene.lighting.as_coverage.value_or(lights.empty())) {  // render/view/shading.hpp's litShare()
    constexpr double kAmbient = 0.38, kLight = 0.50, kHeadlight = 0.22;
    ambient.setConstant(kAmbient);
    Light sun;
    sun.direction_W = scene.light_direction_W;
    sun.diffuse.setConstant(kLight);
    Light head;
    head.type = Light::Type::kPoint;
    head.diffuse.setConstant(kHeadlight);
    head.at_camera = true;
    lights.insert(lights.begin(), {sun, head});
    clamps_light = true;
  }
  for (Light& light : lights) light.casts_shadows = light.casts_shadows && scene.lighting.shadows;
}

bool LightSet::shades(std::size_t k) const {
  if (!asksForShadow(lights[k])) return false;
  int before = 0;
  for (std::size_t i = 0; i < k; ++i) before += asksForShadow(lights[i]);
  return before < kMostShadows;
}

}  // namespace aras_visual_servo_sim
