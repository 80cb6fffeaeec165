#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cctype>
#include <string>
#include <vector>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "aras_visual_servo_sim/scene/scene.hpp"

namespace aras_visual_servo_sim {

/** The lights that a scene is drawn with: its own, or those the coverage renderer has. */
struct LightSet {
  static constexpr int kMostShadows = 4;

  Eigen::Vector3d ambient;
  std::vector<Light> lights;
  bool clamps_light = false;  ///< the sum of light on a surface is 1 at most, as in the coverage renderer

  /** @throws RenderError for more than Lighting::kMostLights */
  explicit LightSet(const Scene& scene) : ambient(scene.lighting.ambient), lights(scene.lighting.lights) {
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
    for (Light& light : lights) light.casts_shadows = light.casts_shadows && scene.lighting.shadows && !light.at_camera;
  }

  /** Whether light k throws a shadow. The first kMostShadows that ask for it do. */
  bool shades(std::size_t k) const {
    const auto asks = [](const Light& light) { return light.casts_shadows; };
    return asks(lights[k]) && std::count_if(lights.begin(), lights.begin() + k, asks) < kMostShadows;
  }

  /** Letters of ShaderTraits::lights. */
  std::string letters() const {
    std::string letters;
    for (std::size_t k = 0; k < lights.size(); ++k) {
      const Light& light = lights[k];
      const char letter = light.at_camera                           ? 'h'
                          : light.type == Light::Type::kDirectional ? 'd'
                          : light.type == Light::Type::kPoint       ? 'p'
                                                                    : 's';
      letters += shades(k) ? static_cast<char>(std::toupper(letter)) : letter;
    }
    return letters;
  }
};

}  // namespace aras_visual_servo_sim
