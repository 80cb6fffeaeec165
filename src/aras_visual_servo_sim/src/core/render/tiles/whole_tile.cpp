#include "whole_tile.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "aras_visual_servo_sim/config/wide.hpp"
#include "aras_visual_servo_sim/image/pixel_color.hpp"
#include "render/view/pixel_rays.hpp"
#include "tile_bins.hpp"

namespace aras_visual_servo_sim {
namespace {

constexpr int kTile = TileBins::kTile, kPixels = kTile * kTile;

struct TileColors {
  double red[kPixels], green[kPixels], blue[kPixels];
};

/** Colours along a row of pixels: (over + slope x) / (under + under_x x). */
ARAS_WIDE void shadeRow(const double* x, const double* slope, const double* over, double under_x, double under,
                        int first, TileColors& colors) {
  double *red = colors.red + first, *green = colors.green + first, *blue = colors.blue + first;
  for (int i = 0; i < kTile; ++i) {
    const double scale = 1.0 / (under + under_x * x[i]);
    red[i] = (over[0] + slope[0] * x[i]) * scale;
    green[i] = (over[1] + slope[1] * x[i]) * scale;
    blue[i] = (over[2] + slope[2] * x[i]) * scale;
  }
}

/** Colours along rays. @param over  3 x 3, column by column */
ARAS_WIDE void shadeRays(const double* x, const double* y, const double* z, const double* over, const double* under,
                         int count, TileColors& colors) {
  for (int i = 0; i < count; ++i) {
    const double scale = 1.0 / (under[0] * x[i] + under[1] * y[i] + under[2] * z[i]);
    colors.red[i] = (over[0] * x[i] + over[3] * y[i] + over[6] * z[i]) * scale;
    colors.green[i] = (over[1] * x[i] + over[4] * y[i] + over[7] * z[i]) * scale;
    colors.blue[i] = (over[2] * x[i] + over[5] * y[i] + over[8] * z[i]) * scale;
  }
}

/** Of near_m / Z over the tile. */
struct Depths {
  float farthest, nearest;
};

Depths depthsOf(const TileTriangle& t, const CameraModel& camera, const PixelBox& tile) {
  const auto x = [&camera](double u) { return static_cast<float>((u - 0.5 - camera.cx()) / camera.fx()); };
  const auto y = [&camera](double v) { return static_cast<float>((v - 0.5 - camera.cy()) / camera.fy()); };
  const float x0 = t.plane[0] * x(tile.u0), x1 = t.plane[0] * x(tile.u1);
  const float y0 = t.plane[1] * y(tile.v0), y1 = t.plane[1] * y(tile.v1);
  const float middle = t.plane[2] + t.bias;
  return {middle + std::min(x0, x1) + std::min(y0, y1), middle + std::max(x0, x1) + std::max(y0, y1)};
}

bool covers(const TileTriangle& t, const PixelBox& tile) {
  const auto width = static_cast<float>(tile.u1 - tile.u0), height = static_cast<float>(tile.v1 - tile.v0);
  for (int k = 0; k < 3; ++k) {
    if (!(t.c[k] + std::min(t.a[k] * width, 0.0f) + std::min(t.b[k] * height, 0.0f) > 0.0f)) return false;
  }
  return true;
}

/** Through a lens. The nearest in the middle is the only one that can be it. */
const TileTriangle* wholeFrontOfCone(const CameraModel& camera, const TriangleList& list,
                                     const std::vector<TileTriangle>& candidates, const RayCone& cone) {
  const TileTriangle* front = nullptr;
  double nearest = 0.0;
  for (const TileTriangle& t : candidates) {
    const Facet& facet = list.facet(t.triangle);
    const double here = facet.plane.dot(cone.axis);
    if (here <= nearest || !std::all_of(facet.edges.begin(), facet.edges.end(), [&cone](const Eigen::Vector3d& edge) {
          return rangeOver(cone, edge).least > 0.0;
        })) {
      continue;
    }
    front = &t;
    nearest = here;
  }
  if (!front) return nullptr;
  const Facet& facet = list.facet(front->triangle);
  // Beyond near_m whatever the length of a ray: 1 of the fisheye, Z = 1 of other lenses.
  const double longest = camera.lens() == CameraModel::Lens::kEquidistant ? 2.0 : std::hypot(1.0, camera.imageRadius());
  if (rangeOver(cone, facet.plane).greatest * camera.nearM() * longest >= 1.0) return nullptr;
  for (const TileTriangle& t : candidates) {
    const Facet& other = list.facet(t.triangle);
    if (&t == front) continue;
    if (camera.nearM() * rangeOver(cone, facet.plane - other.plane).least <= std::abs(other.bias - facet.bias)) {
      return nullptr;
    }
  }
  return front;
}

}  // namespace

const TileTriangle* wholeFront(const CameraModel& camera, const TriangleList& list,
                               const std::vector<TileTriangle>& candidates, const PixelBox& tile, const RayCone& cone) {
  if (!list.isFlat()) return wholeFrontOfCone(camera, list, candidates, cone);
  const TileTriangle* front = nullptr;
  float floor = 0.0f;
  for (const TileTriangle& t : candidates) {
    if (!covers(t, tile)) continue;
    const float farthest = depthsOf(t, camera, tile).farthest;
    if (farthest <= floor) continue;
    front = &t;
    floor = farthest;
  }
  if (!front) return nullptr;
  for (const TileTriangle& t : candidates) {
    if (&t != front && depthsOf(t, camera, tile).nearest >= floor) return nullptr;
  }
  return front;
}

template <typename Value>
void shadeTile(const CameraModel& camera, const Facet& facet, const PixelBox& tile, ImageOf<Value>& image) {
  // With b = areal * ray, colour = rgb * b / sum(b): three linear functions of the ray over a fourth.
  Eigen::Matrix3d rgb;
  for (int k = 0; k < 3; ++k) rgb.col(k) = facet.rgb[k].cast<double>();
  const Eigen::Matrix3d over = rgb * facet.areal;
  const Eigen::Vector3d& under = facet.plane;
  const int width = tile.u1 - tile.u0, count = (tile.v1 - tile.v0) * kTile;
  TileColors colors;
  if (camera.lens() == CameraModel::Lens::kNone) {
    double x[kTile] = {};
    for (int i = 0; i < width; ++i) x[i] = (tile.u0 + i - camera.cx()) / camera.fx();
    for (int v = tile.v0; v < tile.v1; ++v) {
      const double y = (v - camera.cy()) / camera.fy();
      const Eigen::Vector3d over_row = over.col(1) * y + over.col(2);
      shadeRow(x, over.col(0).data(), over_row.data(), under[0], under[1] * y + under[2], (v - tile.v0) * kTile,
               colors);
    }
  } else {
    double x[kPixels] = {}, y[kPixels] = {}, z[kPixels];
    std::fill(std::begin(z), std::end(z), 1.0);
    for (int v = tile.v0; v < tile.v1; ++v) {
      for (int i = 0; i < width; ++i) {
        const Eigen::Vector3d ray = PixelRays::of(camera, tile.u0 + i, v).middle;
        const int p = (v - tile.v0) * kTile + i;
        x[p] = ray.x();
        y[p] = ray.y();
        z[p] = ray.z();
      }
    }
    shadeRays(x, y, z, over.data(), under.data(), count, colors);
  }
  const bool bgr = image.encoding == Encoding::kBgr8;
  for (int v = tile.v0; v < tile.v1; ++v) {
    Value* out = image.pixel(tile.u0, v);
    const int row = (v - tile.v0) * kTile;
    const double *red = colors.red + row, *green = colors.green + row, *blue = colors.blue + row;
    if (image.encoding == Encoding::kMono8) {
      for (int i = 0; i < width; ++i) out[i] = valueOf<Value>(luma(red[i], green[i], blue[i]));
      continue;
    }
    std::int32_t values[3][kTile];
    constexpr double kUnits = kUnitsOf<Value>;
    for (int i = 0; i < kTile; ++i) {
      values[0][i] = static_cast<std::int32_t>((bgr ? blue : red)[i] * kUnits + 0.5);
      values[1][i] = static_cast<std::int32_t>(green[i] * kUnits + 0.5);
      values[2][i] = static_cast<std::int32_t>((bgr ? red : blue)[i] * kUnits + 0.5);
    }
    for (int i = 0; i < width; ++i, out += 3) {
      for (int c = 0; c < 3; ++c) out[c] = static_cast<Value>(values[c][i]);
    }
  }
}

template void shadeTile(const CameraModel& camera, const Facet& facet, const PixelBox& tile, Image& image);
template void shadeTile(const CameraModel& camera, const Facet& facet, const PixelBox& tile, FineImage& image);

}  // namespace aras_visual_servo_sim
