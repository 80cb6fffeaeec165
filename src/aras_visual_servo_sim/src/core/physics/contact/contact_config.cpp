#include "aras_visual_servo_sim/physics/contact_config.hpp"

#include <LinearMath/btConvexHullComputer.h>

#include <cmath>

namespace aras_visual_servo_sim {

ContactConfig::ContactConfig(const ContactsConfig& settings)
    : ground(settings.ground_plane),
      neighbours(settings.neighbours),
      friction(settings.friction),
      frictions(settings.frictions),
      stiffness_n_per_m(settings.stiffness_n_per_m),
      damping_n_s_per_m(settings.damping_n_s_per_m),
      free_bodies(settings.free_bodies) {
  // A list of [a, b], or the one word for all pairs.
  if (settings.pairs.IsScalar()) pairs = {{settings.pairs.Scalar(), settings.pairs.Scalar()}};
  for (const auto& pair : settings.pairs) {
    if (pair.IsSequence() && pair.size() == 2) pairs.emplace_back(pair[0].Scalar(), pair[1].Scalar());
  }
}

ContactConfig contactConfigFromYaml(const YAML::Node& node) {
  return readSection<ContactsConfig>(node, "sim.contacts", [](auto&&...) {});
}

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
