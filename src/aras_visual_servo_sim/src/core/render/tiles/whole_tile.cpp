#include "whole_tile.hpp"

#include <algorithm>
#include <cmath>

#include "aras_visual_servo_sim/image/pixel_color.hpp"
#include "render/view/pixel_rays.hpp"
#include "tile_bins.hpp"

namespace aras_visual_servo_sim {
namespace {

constexpr int kTile = TileBins::kTile;

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

void shadeTile(const CameraModel& camera, const Facet& facet, const PixelBox& tile, Image& image) {
  // With b = areal * ray, colour = rgb * b / sum(b): three linear functions of the ray over a fourth.
  Eigen::Matrix3d rgb;
  for (int k = 0; k < 3; ++k) rgb.col(k) = facet.rgb[k].cast<double>();
  const Eigen::Matrix3d over = rgb * facet.areal;
  const Eigen::Vector3d& under = facet.plane;
  const int width = tile.u1 - tile.u0;
  const bool flat = camera.lens() == CameraModel::Lens::kNone;
  double x[kTile] = {}, y[kTile] = {}, z[kTile] = {}, red[kTile], green[kTile], blue[kTile];
  for (int i = 0; i < width; ++i) x[i] = (tile.u0 + i - camera.cx()) / camera.fx();
  for (int v = tile.v0; v < tile.v1; ++v) {
    if (flat) {
      const double row = (v - camera.cy()) / camera.fy();
      const Eigen::Vector3d over_row = over.col(1) * row + over.col(2);
      const double under_row = under[1] * row + under[2];
      for (int i = 0; i < kTile; ++i) {
        const double scale = 1.0 / (under_row + under[0] * x[i]);
        red[i] = (over_row[0] + over(0, 0) * x[i]) * scale;
        green[i] = (over_row[1] + over(1, 0) * x[i]) * scale;
        blue[i] = (over_row[2] + over(2, 0) * x[i]) * scale;
      }
    } else {
      for (int i = 0; i < width; ++i) {
        const Eigen::Vector3d ray = PixelRays::of(camera, tile.u0 + i, v).middle;
        x[i] = ray.x();
        y[i] = ray.y();
        z[i] = ray.z();
      }
      for (int i = 0; i < kTile; ++i) {
        const double scale = 1.0 / (under[0] * x[i] + under[1] * y[i] + under[2] * z[i]);
        red[i] = (over(0, 0) * x[i] + over(0, 1) * y[i] + over(0, 2) * z[i]) * scale;
        green[i] = (over(1, 0) * x[i] + over(1, 1) * y[i] + over(1, 2) * z[i]) * scale;
        blue[i] = (over(2, 0) * x[i] + over(2, 1) * y[i] + over(2, 2) * z[i]) * scale;
      }
    }
    std::uint8_t* out = image.pixel(tile.u0, v);
    if (image.encoding == Encoding::kMono8) {
      for (int i = 0; i < width; ++i) out[i] = greyOf(red[i], green[i], blue[i]);
      continue;
    }
    const double* first = image.encoding == Encoding::kBgr8 ? blue : red;
    const double* last = image.encoding == Encoding::kBgr8 ? red : blue;
    for (int i = 0; i < width; ++i, out += 3) {
      out[0] = byteOf(first[i]);
      out[1] = byteOf(green[i]);
      out[2] = byteOf(last[i]);
    }
  }
}

}  // namespace aras_visual_servo_sim
