#pragma once

#include <Eigen/Core>

#include "aras_visual_servo_sim/scene/triangle_mesh.hpp"
#include "render/opengl/scene/shadow/shadow_reach.hpp"
#include "render/opengl/view/pinhole_view.hpp"

namespace aras_visual_servo_sim {

/** Whether a mesh can be a backdrop, such as a ground or a wall: few triangles that bound a convex body, or lie in one
 *  plane, so that all edges a picture can show of it alone are edges of its faces. */
bool canBeBackdrop(const TriangleMesh& mesh);

/** Adds the parts of a picture in which a backdrop alone may change within a pixel: along the edges of its faces and
 *  where the near and the far plane cut it. @pre canBeBackdrop(mesh)  @param X_CS  pose of the mesh in C */
void addEdges(const TriangleMesh& mesh, const Eigen::Matrix4d& X_CS, const PinholeView& view, double near_m,
              double far_m, PixelParts& parts);

/** Whether all of a part of a picture shows one face of a backdrop, or what stands before it. @pre as of addEdges() */
bool fills(const TriangleMesh& mesh, const Eigen::Matrix4d& X_CS, const PinholeView& view, double near_m, double far_m,
           const PixelBox& part);

}  // namespace aras_visual_servo_sim
