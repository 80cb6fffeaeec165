#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <utility>
#include <vector>

#include "aras_visual_servo_sim/scene/triangle_mesh.hpp"
#include "pinhole_view.hpp"

namespace aras_visual_servo_sim {

/** Triangles of a mesh that follow each other, and the box about them. */
struct TriangleBlock {
  int first = 0, count = 0;  ///< indices
  Eigen::Vector3f middle = Eigen::Vector3f::Zero(), half = Eigen::Vector3f::Zero();
};

/** Cuts some of a mesh's triangles into blocks. @param first, count  of the indices, three to a triangle */
std::vector<TriangleBlock> blocksOf(const TriangleMesh& mesh, const std::vector<std::uint32_t>& indices, int first,
                                    int count);

/** Runs of indices, first and count each, without the blocks that a view sees nothing of. A row of a rolling shutter
 *  sees few of a mesh's triangles, and transforming the others would be most of its work. */
std::vector<std::pair<int, int>> seenRuns(const std::vector<TriangleBlock>& blocks, const Eigen::Matrix4d& X_CS,
                                          const PinholeView& view, double near_m);

}  // namespace aras_visual_servo_sim
