#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "render/triangles/triangle_list.hpp"
#include "render/view/pixel_rays.hpp"
#include "tile_bins.hpp"

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
  float most;  ///< that near_m / Z is nowhere larger than; a plane seen edge-on goes on far beyond its triangle

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

/** The rays of a tile's pixels, rounded. */
class TileRays {
 public:
  static constexpr int kPixels = TileBins::kTile * TileBins::kTile;
  /** x, y and z of the rays through the middles, then of across and of down, for all pixels each. */
  using Values = float[9][kPixels];

  void set(int pixel, const PixelRays& rays);
  const Values& values() const { return values_; }
  /** Products of a normal and the pixel's rays. */
  float middle(const float* normal, int pixel) const { return product<0>(normal, pixel); }
  float across(const float* normal, int pixel) const { return product<3>(normal, pixel); }
  float down(const float* normal, int pixel) const { return product<6>(normal, pixel); }

 private:
  template <int kFirst>
  float product(const float* normal, int p) const {
    return normal[0] * values_[kFirst][p] + normal[1] * values_[kFirst + 1][p] + normal[2] * values_[kFirst + 2][p];
  }

  Values values_;
};

/** What the pixels of a tile see of a triangle. */
class TileSight {
 public:
  static constexpr int kPixels = TileRays::kPixels;
  /** Bits of a pixel. Bit k of the lowest three: edge k crosses the pixel's square. */
  static constexpr std::int32_t kEdges = 7;
  static constexpr std::int32_t kNothing = 8;  ///< the triangle lies aside, behind what is in front, or is too near
  static constexpr std::int32_t kCut = 16;     ///< the near plane may cut the triangle there

  /** Looks at the pixels of rows first <= v < last of the tile.
   *  @param floor  of each pixel, the near_m / Z behind which nothing is seen
   *  @param ahead  of each pixel, that of what lies on the near plane */
  void look(const TileTriangle& triangle, bool flat, const TileRays& rays, const float* floor, const float* ahead,
            int first, int last);
  std::int32_t of(int pixel) const { return bits_[pixel]; }
  /** Bounds of near_m / Z over the pixel's square. */
  float nearest(int pixel) const { return nearest_[pixel]; }
  float farthest(int pixel) const { return farthest_[pixel]; }

 private:
  std::array<std::int32_t, kPixels> bits_;
  std::array<float, kPixels> nearest_, farthest_;
};

}  // namespace aras_visual_servo_sim
