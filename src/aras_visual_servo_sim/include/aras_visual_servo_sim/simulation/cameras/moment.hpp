#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "aras_visual_servo_sim/config/types.hpp"
#include "aras_visual_servo_sim/scene/scene.hpp"
#include "aras_visual_servo_sim/simulation/models/model_set.hpp"

namespace aras_visual_servo_sim {

/** Poses, at one tick, of everything that a camera can see. */
struct Moment {
  std::int64_t tick = 0;
  Pose X_WC;
  std::vector<Pose> models;  ///< X_WM, in the order of the scene
  std::vector<Pose> bodies;  ///< X_WB, in the order of the scene
  std::vector<Pose> lights;  ///< X_WA of what carries them, of the attached ones in the order of the scene
};

/** @param scene  as it is at this tick */
Moment momentOf(std::int64_t tick, const Pose& X_WC, const Scene& scene);

/** Puts everything in the scene where it was. */
void show(const Moment& moment, Scene& scene);

/** X_WM by name of the models of a set as they were. */
std::map<std::string, Pose> modelPoses(const Moment& moment, const ModelSet& set);

}  // namespace aras_visual_servo_sim
