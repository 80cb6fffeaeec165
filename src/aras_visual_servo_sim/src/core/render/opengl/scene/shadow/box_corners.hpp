#pragma once

#include <Eigen/Core>

#include "aras_visual_servo_sim/scene/triangle_mesh.hpp"

namespace aras_visual_servo_sim {

constexpr int kCorners = 8;  ///< of a box

/** Corner of a mesh's box: bits 0, 1, 2 of k choose the side in x, y, z. */
inline Eigen::Vector3d cornerOf(const TriangleMesh& mesh, int k) {
  return Eigen::Vector3f(k & 1 ? mesh.box_max.x() : mesh.box_min.x(), k & 2 ? mesh.box_max.y() : mesh.box_min.y(),
                         k & 4 ? mesh.box_max.z() : mesh.box_min.z())
      .cast<double>();
}

}  // namespace aras_visual_servo_sim
