#pragma once

#include "aras_visual_servo_sim/scene/triangle_mesh.hpp"

namespace aras_visual_servo_sim {

/** Whether each triangle has one normal and one colour. */
bool isFaceted(const TriangleMesh& mesh);

/** A surface with fewer triangles, for who sees it from afar: points that are left stay where they are, with their
 *  normals and colours.
 *  @param mesh     without pictures, which would be pulled askew
 *  @param error_m  how far it may be from where it is, > 0; the mean over what is put together counts, not the farthest
 *  @return  null where less than a third of the triangles would go */
MeshPtr simplified(const TriangleMesh& mesh, double error_m);

}  // namespace aras_visual_servo_sim
