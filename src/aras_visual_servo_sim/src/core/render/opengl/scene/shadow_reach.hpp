#pragma once

#include <Eigen/Core>

#include "aras_visual_servo_sim/scene/triangle_mesh.hpp"
#include "render/opengl/view/pinhole_view.hpp"
#include "shadow_maps.hpp"

namespace aras_visual_servo_sim {

/** Pixels of a picture: `left` to before `right`, `top` to before `bottom`. */
struct PixelPart {
  int left = 0, top = 0, right = 0, bottom = 0;

  bool empty() const { return left >= right || top >= bottom; }
  double area() const { return empty() ? 0.0 : double(right - left) * (bottom - top); }
  /** Both, and what lies between them. */
  PixelPart with(const PixelPart& other) const;
  /** What both share; empty if they share nothing, and then still inside the other. */
  PixelPart within(const PixelPart& other) const;
};

/** The part of a picture that a mesh can cover. @param X_CS  pose of the mesh in C  @param near_m  of the camera */
PixelPart coveredPart(const TriangleMesh& mesh, const Eigen::Matrix4d& X_CS, const PinholeView& view, double near_m);

/** The part of a picture in which a mesh can lie in the shadow of a directional light. Empty if none of it can.
 *  @param of_camera  the map's coordinates of points in C */
PixelPart shadowedPart(const TriangleMesh& mesh, const Eigen::Matrix4d& X_CS, const ShadowMaps::Map& map,
                       const Eigen::Matrix4d& of_camera, const PinholeView& view, double near_m);

}  // namespace aras_visual_servo_sim
