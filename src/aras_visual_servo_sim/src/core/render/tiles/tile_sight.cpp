#include "tile_sight.hpp"

#include <cmath>

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

  /** @param middle  near_m / Z in the pixels' middles @param half  how much it varies from there over their squares */
  [[gnu::always_inline]] void setDepth(const EightFloats& middle, const EightFloats& half, const float* floor,
                                       const float* ahead) {
    nearest = middle + half;
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
        reach + EightFloats{}, floor + p, ahead + p);
    for (int k = 0; k < 3; ++k) {
      const float half = 0.5f * (std::abs(t.a[k]) + std::abs(t.b[k]));
      row.addEdge(k, t.a[k] * x + t.b[k] * y + t.c[k], half + EightFloats{});
    }
    row.store(nearest + p, farthest + p, bits + p);
  }
}

/** Products of a normal and the rays of the row of pixels from p: in their middles, and how much they vary over a
 * square. */
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
    row.setDepth(middle + t.bias, half, floor + p, ahead + p);
    for (int k = 0; k < 3; ++k) {
      measure(t.edge[k], rays, p, middle, half);
      row.addEdge(k, middle, half);
    }
    row.store(nearest + p, farthest + p, bits + p);
  }
}

}  // namespace

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
