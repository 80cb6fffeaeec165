#include "tile_sight.hpp"

#include <cmath>

#include "aras_visual_servo_sim/config/wide.hpp"
#include "render/pixels/eight.hpp"

namespace aras_visual_servo_sim {
namespace {

constexpr int kSide = TileBins::kTile;

/** Bits of an edge, from the least and the most of the distances to it over a pixel's square, in any unit. */
inline std::int32_t bitsOf(int edge, float least, float most) {
  return (least > 0.0f ? 0 : 1 << edge) | (most < 0.0f ? TileSight::kNothing : 0);
}

/** Bits of the depth between these bounds of near_m / Z. */
inline std::int32_t bitsOfDepth(float farthest, float nearest, float floor, float ahead) {
  return (nearest < floor ? TileSight::kNothing : 0) | (farthest > ahead ? TileSight::kNothing : 0) |
         (nearest > ahead ? TileSight::kCut : 0);
}

/** Without a lens: everything is linear over the tile. */
ARAS_WIDE void lookFlat(const TileTriangle& t, const TileRays::Values& rays, const float* __restrict floor,
                        const float* __restrict ahead, const PixelBox& pixels, float* __restrict nearest,
                        float* __restrict farthest, std::int32_t* __restrict bits) {
  const float a0 = t.a[0], a1 = t.a[1], a2 = t.a[2], b0 = t.b[0], b1 = t.b[1], b2 = t.b[2];
  const float c0 = t.c[0], c1 = t.c[1], c2 = t.c[2];
  const float half0 = 0.5f * (std::abs(a0) + std::abs(b0)), half1 = 0.5f * (std::abs(a1) + std::abs(b1)),
              half2 = 0.5f * (std::abs(a2) + std::abs(b2));
  const float* __restrict ray_x = rays[0];
  const float* __restrict ray_y = rays[1];
  const float reach = 0.5f * (std::abs(t.plane[0] * rays[3][0]) + std::abs(t.plane[1] * rays[7][0]));
  const float z_x = t.plane[0], z_y = t.plane[1], z_1 = t.plane[2], bias = t.bias;
  for (int p = pixels.v0 * kSide; p < pixels.v1 * kSide; ++p) {
    const float x = p % kSide + 0.5f, y = p / kSide + 0.5f;  // NOLINT
    const float e0 = a0 * x + b0 * y + c0, e1 = a1 * x + b1 * y + c1, e2 = a2 * x + b2 * y + c2;
    const float z = z_x * ray_x[p] + z_y * ray_y[p] + z_1 + bias;
    farthest[p] = z - reach;
    nearest[p] = z + reach;
    bits[p] = bitsOf(0, e0 - half0, e0 + half0) | bitsOf(1, e1 - half1, e1 + half1) |
              bitsOf(2, e2 - half2, e2 + half2) | bitsOfDepth(z - reach, z + reach, floor[p], ahead[p]);
  }
}

/** Products of a normal and the rays of eight pixels from p: in their middles, and how much they vary over a square. */
[[gnu::always_inline]] inline void measure(const float* normal, const TileRays::Values& rays, int p,
                                           EightFloats& middle, EightFloats& half) {
  const float x = normal[0], y = normal[1], z = normal[2];
  middle = x * eightAt(rays[0] + p) + y * eightAt(rays[1] + p) + z * eightAt(rays[2] + p);
  EightFloats across = x * eightAt(rays[3] + p) + y * eightAt(rays[4] + p) + z * eightAt(rays[5] + p);
  EightFloats down = x * eightAt(rays[6] + p) + y * eightAt(rays[7] + p) + z * eightAt(rays[8] + p);
  dropSigns(across);
  dropSigns(down);
  half = 0.5f * (across + down);
}

/** Through a lens. */
ARAS_WIDE void lookBent(const TileTriangle& t, const TileRays::Values& rays, const float* floor, const float* ahead,
                        const PixelBox& pixels, float* nearest, float* farthest, std::int32_t* bits) {
  constexpr int kEight = 8;
  for (int v = pixels.v0; v < pixels.v1; ++v) {
    for (int p = v * kSide + pixels.u0 / kEight * kEight; p < v * kSide + pixels.u1; p += kEight) {
      EightFloats z, half;
      measure(t.plane, rays, p, z, half);
      z += t.bias;
      const EightFloats near = z + half, far = z - half;
      EightInts sight = (((near < eightAt(floor + p)) | (far > eightAt(ahead + p))) & TileSight::kNothing) |
                        ((near > eightAt(ahead + p)) & TileSight::kCut);
      for (int k = 0; k < 3; ++k) {
        measure(t.edge[k], rays, p, z, half);
        sight |= (~(z - half > 0.0f) & (1 << k)) | ((z + half < 0.0f) & TileSight::kNothing);
      }
      eightAt(nearest + p) = near;
      eightAt(farthest + p) = far;
      eightAt(bits + p) = sight;
    }
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
                     const PixelBox& pixels) {
  (flat ? lookFlat : lookBent)(t, rays.values(), floor, ahead, pixels, nearest_.data(), farthest_.data(), bits_.data());
}

}  // namespace aras_visual_servo_sim
