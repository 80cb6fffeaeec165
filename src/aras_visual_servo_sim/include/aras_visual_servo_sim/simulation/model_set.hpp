#pragma once

#include <map>
#include <string>
#include <vector>

#include "aras_visual_servo_sim/config/types.hpp"
#include "aras_visual_servo_sim/scene/scene.hpp"

namespace aras_visual_servo_sim {

/** Models of a Simulation, with the robot's own bodies among those of the scene. */
struct ModelSet {
  Scene scene;
  std::vector<int> body_links;                 ///< link of each body of the scene, -1 for solids
  std::map<std::string, Pose> starts;          ///< of each model
  std::map<std::string, std::string> spawned;  ///< entry, as YAML, of each model that was spawned
};

/** A model in a saved state. */
struct SavedModel {
  std::string name, entry;  ///< entry: empty unless it was spawned
  Pose X_WM, X_WM0;         ///< where it is, where it started
};

}  // namespace aras_visual_servo_sim
