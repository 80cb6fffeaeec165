#include "tile_triangle.hpp"

#include <algorithm>
#include <limits>

namespace aras_visual_servo_sim {

bool TileTriangle::set(const TriangleList& list, std::uint32_t index, double near_m, const PixelBox& tile,
                       const RayCone& cone) {
  triangle = index;
  const Facet& facet = list.facet(index);
  surface = facet.surface;
  for (int k = 0; k < 3; ++k) plane[k] = static_cast<float>(near_m * facet.plane[k]);
  bias = static_cast<float>(facet.bias);
  if (!list.isFlat()) return setEdges(facet, cone);
  const Vertex* t = &list.vertices()[3 * std::size_t(index)];
  const double area =
      (double(t[1].x) - t[0].x) * (double(t[2].y) - t[0].y) - (double(t[1].y) - t[0].y) * (double(t[2].x) - t[0].x);
  if (area == 0.0) return false;
  for (int i = 0, j = 2; i < 3; j = i++) {
    // From the same end whichever triangle asks, so that both get the same numbers of opposite signs.
    const bool turned = t[j].x > t[i].x || (t[j].x == t[i].x && t[j].y > t[i].y);
    const Vertex &from = turned ? t[i] : t[j], &to = turned ? t[j] : t[i];
    const double dx = double(to.x) - from.x, dy = double(to.y) - from.y;
    const double offset = dx * (tile.v0 - double(from.y)) - dy * (tile.u0 - double(from.x));
    const bool inner = turned == (area < 0.0);  // the inside is where it is positive
    a[i] = static_cast<float>(inner ? -dy : dy);
    b[i] = static_cast<float>(inner ? dx : -dx);
    c[i] = static_cast<float>(inner ? offset : -offset);
    seam[i] = t[j].seam;
    least[i] = inner ? 0.0f : std::numeric_limits<float>::denorm_min();  // on the edge: one of them only
  }
  return true;
}

bool TileTriangle::setEdges(const Facet& facet, const RayCone& cone) {
  for (int k = 0; k < 3; ++k) {
    const Eigen::Vector3d& normal = facet.edges[k];
    if (rangeOver(cone, normal).greatest < 0.0) return false;
    for (int i = 0; i < 3; ++i) edge[k][i] = static_cast<float>(normal[i]);
    seam[k] = facet.seams[k];
    // A ray on the edge belongs to one of the two triangles that share it.
    const auto first = std::find_if(normal.data(), normal.data() + 3, [](double x) { return x != 0.0; });
    least[k] = *first > 0.0 ? 0.0f : std::numeric_limits<float>::denorm_min();
  }
  return true;
}

}  // namespace aras_visual_servo_sim
