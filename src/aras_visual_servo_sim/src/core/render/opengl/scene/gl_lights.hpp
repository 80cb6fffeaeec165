#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "aras_visual_servo_sim/scene/scene.hpp"

namespace aras_visual_servo_sim {

/** The lights that a scene is drawn with: its own, or those the coverage renderer has. */
struct LightSet {
  static constexpr int kMostShadows = 4;

  Eigen::Vector3d ambient;
  std::vector<Light> lights;
  bool clamps_light = false;  ///< the sum of light on a surface is 1 at most, as in the coverage renderer

  /** @throws RenderError for more than Lighting::kMostLights */
  explicit LightSet(const Scene& scene);
  /** Whether light k throws a shadow. The first kMostShadows that ask for it do. */
  bool shades(std::size_t k) const;
};

}  // namespace aras_visual_servo_sim
