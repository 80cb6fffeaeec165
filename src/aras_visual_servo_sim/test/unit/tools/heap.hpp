#pragma once

#include <array>
#include <cmath>
#include <random>
#include <string>

#include "aras_visual_servo_sim/config/types.hpp"
#include "aras_visual_servo_sim/physics/world_config.hpp"

namespace aras_visual_servo_sim {

/** Solids of random kind, size and mass inside each other and the ground; the same for the same
 * seed. */
inline WorldConfig heap(unsigned seed, int solids) {
  std::mt19937 random(seed);
  const auto between = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  WorldConfig config;
  config.contacts.ground = GroundPlane{0.0, between(0.0, 1.5)};
  for (int k = 0; k < solids; ++k) {
    Obstacle solid;
    solid.name = "solid" + std::to_string(k);
    solid.geometry.type =
        std::array{Geometry::Type::kBox, Geometry::Type::kCylinder, Geometry::Type::kSphere}[random() % 3];
    solid.geometry.size_m = {between(0.02, 0.3), between(0.02, 0.3), between(0.02, 0.3)};
    solid.geometry.radius_m = between(0.02, 0.2);
    solid.geometry.length_m = between(0.02, 0.3);
    solid.X_WO = Pose{{between(-0.1, 0.1), between(-0.1, 0.1), between(-0.1, 0.2)},
                      quaternionFromRpy({between(-3, 3), between(-3, 3), between(-3, 3)})};
    solid.mass_kg = std::pow(10.0, between(-2.0, 2.0));
    for (const Obstacle& other : config.contacts.obstacles) config.contacts.pairs.emplace_back(solid.name, other.name);
    config.contacts.obstacles.push_back(solid);
  }
  return config;
}

}  // namespace aras_visual_servo_sim
