#include "seen_blocks.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace aras_visual_servo_sim {
namespace {

constexpr int kBlock = 3 * 64;  // indices: fewer cost more to look at than to draw

/** Planes about what a view can see, in the mesh's frame: normal and distance, positive inside. */
std::array<Eigen::RowVector4f, 5> pyramid(const Eigen::Matrix4d& X_CS, const PinholeView& view, double near_m) {
  constexpr double kMargin = 1.0;  // [px]: rounding is far below it
  const auto [left, right, top, bottom] = view.border(0.5 + kMargin);
  Eigen::Matrix4d X_FS = X_CS;
  X_FS.topRows<3>() = (view.R_FC * X_CS.topRows<3>()).eval();
  const auto plane = [&X_FS](double x, double y, double z, double distance = 0.0) {
    const Eigen::RowVector4d normal = Eigen::RowVector4d(x, y, z, distance) * X_FS;
    return Eigen::RowVector4f((normal / normal.head<3>().norm()).cast<float>());
  };
  return {plane(0, 0, 1, -near_m), plane(0, 1, -top), plane(0, -1, bottom), plane(1, 0, -left), plane(-1, 0, right)};
}

}  // namespace

std::vector<TriangleBlock> blocksOf(const TriangleMesh& mesh, const std::vector<std::uint32_t>& indices, int first,
                                    int count) {
  std::vector<TriangleBlock> blocks;
  for (int done = 0; done < count; done += kBlock) {
    TriangleBlock block{first + done, std::min(kBlock, count - done)};
    Eigen::Vector3f least = mesh.points[indices[block.first]], most = least;
    for (int k = 1; k < block.count; ++k) {
      const Eigen::Vector3f& point = mesh.points[indices[block.first + k]];
      least = least.cwiseMin(point);
      most = most.cwiseMax(point);
    }
    block.middle = 0.5f * (least + most);
    block.half = 0.5f * (most - least);
    blocks.push_back(block);
  }
  return blocks;
}

std::vector<std::pair<int, int>> seenRuns(const std::vector<TriangleBlock>& blocks, const Eigen::Matrix4d& X_CS,
                                          const PinholeView& view, double near_m) {
  const auto planes = pyramid(X_CS, view, near_m);
  const auto isSeen = [&planes](const TriangleBlock& block) {
    const float slack = 1e-5f * (block.middle.norm() + block.half.norm());  // rounding
    return std::all_of(planes.begin(), planes.end(), [&](const Eigen::RowVector4f& plane) {
      const Eigen::RowVector3f normal = plane.head<3>();
      return normal.dot(block.middle) + normal.cwiseAbs().dot(block.half) + plane[3] >
             -slack - 1e-5f * std::abs(plane[3]);
    });
  };
  std::vector<std::pair<int, int>> runs;
  for (const TriangleBlock& block : blocks) {
    if (!isSeen(block)) continue;
    const bool follows = !runs.empty() && runs.back().first + runs.back().second == block.first;
    if (follows) {
      runs.back().second += block.count;
    } else {
      runs.emplace_back(block.first, block.count);
    }
  }
  return runs;
}

}  // namespace aras_visual_servo_sim
