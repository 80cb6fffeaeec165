#pragma once

#include <map>
#include <set>
#include <string>

#include "aras_visual_servo_sim/scene/scene.hpp"

namespace aras_visual_servo_sim {

/** What the coverage renderer does not draw of a scene, and whose it is: names of bodies and lights, an empty one for
 * the scene itself. What a thing has at its default is not listed. */
using Undrawn = std::map<std::string, std::set<std::string>>;

Undrawn undrawnByCoverage(const Scene& scene);

/** "emissive of lamp, screen; fog": for messages. */
std::string textOf(const Undrawn& undrawn);

}  // namespace aras_visual_servo_sim
