#pragma once

#include "aras_visual_servo_sim/scene/triangle_mesh.hpp"

namespace aras_visual_servo_sim {

/** A mesh with the same content that somebody in this process has, else this one. What draws many scenes then knows
 * that they show the same thing. Thread-safe. */
MeshPtr shared(MeshPtr mesh);

}  // namespace aras_visual_servo_sim
