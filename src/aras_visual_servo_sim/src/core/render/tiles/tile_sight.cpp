#include "tile_sight.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "aras_visual_servo_sim/config/wide.hpp"
#include "render/pixels/eight.hpp"

namespace aras_visual_servo_sim {
namespace {

constexpr int kSide = TileBins::kTile;
static_assert(kSide == 8, "a row of a tile is EightFloats");

/** What is known of a row of pixels. */
struct Row {
  EightFloats nearest, farthest;
  EightInts bits;

  /** @param middle  near_m / Z in the pixels' middles @param half  how much it varies from there over their squares
   *  @param most  that it is at most */
  [[gnu::always_inline]] void setDepth(const EightFloats& middle, const EightFloats& half, float most,
                                       const float* floor, const float* ahead) {
    nearest = middle + half;
    nearest = nearest < most ? nearest : most + EightFloats{};
    farthest = middle - half;
    bits = (((nearest < eightAt(floor).values) | (farthest > eightAt(ahead).values)) & TileSight::kNothing) |
           ((nearest > eightAt(ahead).values) & TileSight::kCut);
  }
  /** The same of the distance to edge k, in any unit. */
  [[gnu::always_inline]] void addEdge(int k, const EightFloats& middle, const EightFloats& half) {
    bits |= (~(middle - half > 0.0f) & (1 << k)) | ((middle + half < 0.0f) & TileSight::kNothing);
  }
  [[gnu::always_inline]] void store(float* to_nearest, float* to_farthest, std::int32_t* to_bits) const {
    eightAt(to_nearest).values = nearest;
    eightAt(to_farthest).values = farthest;
    eightAt(to_bits).values = bits;
  }
};

/** Places of the middles of a row's pixels, from the tile's corner [px]. */
constexpr float kColumns[kSide] = {0.5f, 1.5f, 2.5f, 3.5f, 4.5f, 5.5f, 6.5f, 7.5f};

/** Without a lens: everything is linear over the tile. */
ARAS_WIDE void lookFlat(const TileTriangle& t, const TileRays::Values& rays, const float* floor, const float* ahead,
                        int first, int last, float* nearest, float* farthest, std::int32_t* bits) {
  const float reach = 0.5f * (std::abs(t.plane[0] * rays[3][0]) + std::abs(t.plane[1] * rays[7][0]));
  const EightFloats x = eightAt(kColumns).values;
  for (int v = first, p = v * kSide; v < last; ++v, p += kSide) {
    const float y = static_cast<float>(v) + 0.5f;
    Row row;
    row.setDepth(
        t.plane[0] * eightAt(rays[0] + p).values + t.plane[1] * eightAt(rays[1] + p).values + t.plane[2] + t.bias,
        reach + EightFloats{}, t.most, floor + p, ahead + p);
    for (int k = 0; k < 3; ++k) {
      const float half = 0.5f * (std::abs(t.a[k]) + std::abs(t.b[k]));
      row.addEdge(k, t.a[k] * x + t.b[k] * y + t.c[k], half + EightFloats{});
    }
    row.store(nearest + p, farthest + p, bits + p);
  }
}

/** Products of a normal and the rays of eight pixels from p: in their middles, and by how much they vary. */
[[gnu::always_inline]] inline void measure(const float* normal, const TileRays::Values& rays, int p,
                                           EightFloats& middle, EightFloats& half) {
  const float x = normal[0], y = normal[1], z = normal[2];
  middle = x * eightAt(rays[0] + p).values + y * eightAt(rays[1] + p).values + z * eightAt(rays[2] + p).values;
  EightFloats across =
      x * eightAt(rays[3] + p).values + y * eightAt(rays[4] + p).values + z * eightAt(rays[5] + p).values;
  EightFloats down =
      x * eightAt(rays[6] + p).values + y * eightAt(rays[7] + p).values + z * eightAt(rays[8] + p).values;
  dropSigns(across);
  dropSigns(down);
  half = 0.5f * (across + down);
}

/** Through a lens. */
ARAS_WIDE void lookBent(const TileTriangle& t, const TileRays::Values& rays, const float* floor, const float* ahead,
                        int first, int last, float* nearest, float* farthest, std::int32_t* bits) {
  for (int v = first, p = v * kSide; v < last; ++v, p += kSide) {
    EightFloats middle, half;
    Row row;
    measure(t.plane, rays, p, middle, half);
    row.setDepth(middle + t.bias, half, t.most, floor + p, ahead + p);
    for (int k = 0; k < 3; ++k) {
      measure(t.edge[k], rays, p, middle, half);
      row.addEdge(k, middle, half);
    }
    row.store(nearest + p, farthest + p, bits + p);
  }
}

}  // namespace

bool TileTriangle::set(const TriangleList& list, std::uint32_t index, double near_m, const PixelBox& tile,
                       const RayCone& cone) {
  triangle = index;
  const Facet& facet = list.facet(index);
  surface = facet.surface;
  for (int k = 0; k < 3; ++k) plane[k] = static_cast<float>(near_m * facet.plane[k]);
  bias = static_cast<float>(facet.bias);
  constexpr float kRounding = 1.0f + 8.0f * std::numeric_limits<float>::epsilon();
  most = kRounding * static_cast<float>(near_m * facet.nearest + facet.bias);
  if (!list.isFlat()) {
    most = std::numeric_limits<float>::infinity();  // rays have unit length there
    return setEdges(facet, cone);
  }
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

void TileRays::set(int pixel, const PixelRays& rays) {
  for (int k = 0; k < 3; ++k) {
    values_[k][pixel] = static_cast<float>(rays.middle[k]);
    values_[3 + k][pixel] = static_cast<float>(rays.across[k]);
    values_[6 + k][pixel] = static_cast<float>(rays.down[k]);
  }
}

void TileSight::look(const TileTriangle& t, bool flat, const TileRays& rays, const float* floor, const float* ahead,
                     int first, int last) {
  (flat ? lookFlat : lookBent)(t, rays.values(), floor, ahead, first, last, nearest_.data(), farthest_.data(),
                               bits_.data());
}

}  // namespace aras_visual_servo_sim
