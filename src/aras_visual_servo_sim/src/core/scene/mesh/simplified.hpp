#pragma once

#include "aras_visual_servo_sim/scene/triangle_mesh.hpp"

namespace aras_visual_servo_sim {

/** Whether each triangle has one normal and one colour. */
bool isFaceted(const TriangleMesh& mesh);

/** A surface with fewer triangles; null: there is none that is worth while. */
struct Simplified {
  MeshPtr mesh{};
  double error_m = 0.0;  ///< how far it is from where it was: the mean over what was put together
};

/** Puts triangles together for who sees them from afar: points that are left stay where they are, creases and the
 *  borders of colours too.
 *  @param mesh     without pictures, which would be pulled askew
 *  @param error_m  allowed, > 0
 *  @return  no mesh where less than a third of the triangles would go */
Simplified simplified(const TriangleMesh& mesh, double error_m);

}  // namespace aras_visual_servo_sim
