#include "aras_visual_servo_sim/physics/hollow_mesh.hpp"

#include <LinearMath/btConvexHullComputer.h>

#include <cmath>

namespace aras_visual_servo_sim {

bool isHollow(const std::vector<Eigen::Vector3d>& points, const std::vector<std::array<std::uint32_t, 3>>& triangles) {
  constexpr double kConvexShare = 0.9;
  const auto volume = [](const auto& a, const auto& b, const auto& c) { return a.dot(b.cross(c)) / 6.0; };
  double filled = 0.0, hull = 0.0;
  for (const auto& [a, b, c] : triangles) filled += volume(points[a], points[b], points[c]);
  btConvexHullComputer computer;
  computer.compute(points.front().data(), sizeof(points.front()), static_cast<int>(points.size()), 0.0, 0.0);
  for (int face = 0; face < computer.faces.size(); ++face) {
    const auto* edge = &computer.edges[computer.faces[face]];
    const int start = edge->getSourceVertex();
    while (edge->getTargetVertex() != start) {
      const auto* next = edge->getNextEdgeOfFace();
      hull += volume(computer.vertices[start], computer.vertices[edge->getTargetVertex()],
                     computer.vertices[next->getTargetVertex()]);
      edge = next;
    }
  }
  return !(std::abs(filled) >= kConvexShare * std::abs(hull)) || hull == 0.0;
}

}  // namespace aras_visual_servo_sim
