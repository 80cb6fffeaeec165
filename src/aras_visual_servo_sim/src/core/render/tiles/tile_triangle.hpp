#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "render/coverage/coverage_rasterizer.hpp"
#include "render/triangles/triangle_list.hpp"

namespace aras_visual_servo_sim {

/** A projected triangle about a tile of the image, and its plane, near_m / Z = plane . ray + bias.
 *
 *  Without a lens its edges are half-planes a x + b y + c >= least, x and y from the tile's corner [px]; through a lens
 *  they are planes of rays, edge . ray >= least. */
struct TileTriangle {
  std::uint32_t triangle;  ///< index into the list
  std::uint32_t surface;
  std::array<float, 3> a, b, c, least;
  float edge[3][3];
  std::array<bool, 3> seam;  ///< of each edge: see Vertex
  float plane[3], bias;

  /** @param tile  pixels of the tile @param cone  its rays @return false if the triangle has nothing in the tile */
  bool set(const TriangleList& list, std::uint32_t index, double near_m, const PixelBox& tile, const RayCone& cone);

 private:
  bool setEdges(const Facet& facet, const RayCone& cone);
};

/** Least and greatest of normal . ray over the rays of unit length in a cone. */
struct ConeRange {
  double least, greatest;
};
inline ConeRange rangeOver(const RayCone& cone, const Eigen::Vector3d& normal) {
  const double along = normal.dot(cone.axis), aside = std::sqrt(std::max(0.0, normal.squaredNorm() - along * along));
  const double size = std::sqrt(along * along + aside * aside);
  // Angles to the axis: of the normal a, of the rays at most b. The extremes are at |a| -+ b, if they are not beyond.
  const double least = along * cone.cosine - aside * cone.sine, greatest = along * cone.cosine + aside * cone.sine;
  return {along < 0.0 && aside * cone.cosine < -along * cone.sine ? -size : least,
          along > 0.0 && aside * cone.cosine < along * cone.sine ? size : greatest};
}

}  // namespace aras_visual_servo_sim
