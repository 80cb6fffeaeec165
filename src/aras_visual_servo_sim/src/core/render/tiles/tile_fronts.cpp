#include "tile_fronts.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "aras_visual_servo_sim/config/wide.hpp"

namespace aras_visual_servo_sim {
namespace {

constexpr std::size_t kMostFacets = 16;  // of a tile: each is shaded over all of it

bool covers(const TileTriangle& t, const PixelBox& tile) {
  const auto width = static_cast<float>(tile.u1 - tile.u0), height = static_cast<float>(tile.v1 - tile.v0);
  for (int k = 0; k < 3; ++k) {
    if (!(t.c[k] + std::min(t.a[k] * width, 0.0f) + std::min(t.b[k] * height, 0.0f) > 0.0f)) return false;
  }
  return true;
}

/** Where the tile lies to a triangle. */
enum class Meeting { kApart, kSmooth, kRim };

/** kSmooth: none of its edges crosses the tile but seams. */
Meeting meetingOf(const TileTriangle& t, const PixelBox& tile) {
  const auto width = static_cast<float>(tile.u1 - tile.u0), height = static_cast<float>(tile.v1 - tile.v0);
  bool rim = false;
  for (int k = 0; k < 3; ++k) {
    const float x = t.a[k] * width, y = t.b[k] * height;
    if (t.c[k] + std::max(x, 0.0f) + std::max(y, 0.0f) < 0.0f) return Meeting::kApart;
    rim = rim || (!t.seam[k] && !(t.c[k] + std::min(x, 0.0f) + std::min(y, 0.0f) > 0.0f));
  }
  return rim ? Meeting::kRim : Meeting::kSmooth;
}

/** The pixels whose middles lie in a triangle nearer than what they saw before see number `index`. @param x, y  rays */
ARAS_WIDE void see(const TileTriangle& t, std::int32_t index, const float* x, const float* y, float* nearest,
                   std::int32_t* front) {
  const float a0 = t.a[0], a1 = t.a[1], a2 = t.a[2], b0 = t.b[0], b1 = t.b[1], b2 = t.b[2];
  const float c0 = t.c[0], c1 = t.c[1], c2 = t.c[2], l0 = t.least[0], l1 = t.least[1], l2 = t.least[2];
  const float p0 = t.plane[0], p1 = t.plane[1], p2 = t.plane[2], bias = t.bias;
  constexpr int kTile = TileFronts::kTile;
  for (int v = 0; v < kTile; ++v) {
    const float row = static_cast<float>(v) + 0.5f, down = p1 * y[v];
    float* depth = nearest + v * kTile;
    std::int32_t* seen = front + v * kTile;
    for (int u = 0; u < kTile; ++u) {
      const float column = static_cast<float>(u) + 0.5f;
      const float z = p0 * x[u] + down + p2 + bias;
      const std::int32_t inside = -std::int32_t(a0 * column + b0 * row + c0 >= l0) &
                                  -std::int32_t(a1 * column + b1 * row + c1 >= l1) &
                                  -std::int32_t(a2 * column + b2 * row + c2 >= l2) & -std::int32_t(z > depth[u]);
      depth[u] = inside != 0 ? z : depth[u];
      seen[u] = inside != 0 ? index : seen[u];
    }
  }
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

bool TileFronts::find(const CameraModel& camera, const TriangleList& list, const std::vector<TileTriangle>& candidates,
                      const PixelBox& tile, const RayCone& cone) {
  if (findOne(camera, list, candidates, tile, cone)) return true;
  if (!list.isFlat()) return false;
  if (camera.sampling() == CameraModel::Sampling::kCenter) {
    members_.resize(candidates.size());
    std::iota(members_.begin(), members_.end(), 0);
  } else if (!collectSurface(camera, list, candidates, tile)) {
    return false;
  }
  return select(camera, list, candidates, tile);
}

TileFronts::Depths TileFronts::depthsOf(const TileTriangle& t, const CameraModel& camera, const PixelBox& tile) {
  const auto x = [&camera](double u) { return static_cast<float>((u - 0.5 - camera.cx()) / camera.fx()); };
  const auto y = [&camera](double v) { return static_cast<float>((v - 0.5 - camera.cy()) / camera.fy()); };
  const float x0 = t.plane[0] * x(tile.u0), x1 = t.plane[0] * x(tile.u1);
  const float y0 = t.plane[1] * y(tile.v0), y1 = t.plane[1] * y(tile.v1);
  const float middle = t.plane[2] + t.bias;
  return {middle + std::min(x0, x1) + std::min(y0, y1), middle + std::max(x0, x1) + std::max(y0, y1)};
}

/** One triangle covers every pixel and lies in front of all others there. */
bool TileFronts::findOne(const CameraModel& camera, const TriangleList& list,
                         const std::vector<TileTriangle>& candidates, const PixelBox& tile, const RayCone& cone) {
  const TileTriangle* front = nullptr;
  if (list.isFlat()) {
    float floor = 0.0f;
    for (const TileTriangle& t : candidates) {
      if (!covers(t, tile)) continue;
      const float farthest = depthsOf(t, camera, tile).farthest;
      if (farthest <= floor) continue;
      front = &t;
      floor = farthest;
    }
    if (!front) return false;
    for (const TileTriangle& t : candidates) {
      if (&t != front && depthsOf(t, camera, tile).nearest >= floor) return false;
    }
  } else {
    front = wholeFrontOfCone(camera, list, candidates, cone);
    if (!front) return false;
  }
  facets_.assign(1, &list.facet(front->triangle));
  return true;
}

/** Sets members_ to the triangles of the surface that lies in front of all others in the tile.
 *  @return false if it has an edge in the tile, a crease, or others may lie before it */
bool TileFronts::collectSurface(const CameraModel& camera, const TriangleList& list,
                                const std::vector<TileTriangle>& candidates, const PixelBox& tile) {
  const TileTriangle* front = nullptr;
  float nearest = 0.0f;
  for (const TileTriangle& t : candidates) {
    const float here = depthsOf(t, camera, tile).nearest;
    if (here <= nearest || meetingOf(t, tile) == Meeting::kApart) continue;
    front = &t;
    nearest = here;
  }
  if (!front) return false;
  members_.clear();
  float floor = nearest;
  const Eigen::Array3f first = list.facet(front->triangle).rgb[0].array();
  Eigen::Array3f low = first, high = first;
  for (std::uint32_t k = 0; k < candidates.size(); ++k) {
    const TileTriangle& t = candidates[k];
    if (t.surface != front->surface) continue;
    const Meeting meeting = meetingOf(t, tile);
    if (meeting == Meeting::kRim) return false;
    if (meeting == Meeting::kApart) continue;
    members_.push_back(k);
    floor = std::min(floor, depthsOf(t, camera, tile).farthest);
    const Eigen::Array3f color = list.facet(t.triangle).rgb[0].array();
    low = low.min(color);
    high = high.max(color);
  }
  if ((high - low).maxCoeff() > kCrease) return false;
  return std::all_of(candidates.begin(), candidates.end(), [&](const TileTriangle& t) {
    return t.surface == front->surface || meetingOf(t, tile) == Meeting::kApart ||
           depthsOf(t, camera, tile).nearest < floor;
  });
}

/** What the middles of the pixels see of members_. @return false if one sees nothing, or all of them too many facets */
bool TileFronts::select(const CameraModel& camera, const TriangleList& list,
                        const std::vector<TileTriangle>& candidates, const PixelBox& tile) {
  float x[kTile], y[kTile];
  for (int i = 0; i < kTile; ++i) {
    x[i] = static_cast<float>((tile.u0 + i - camera.cx()) / camera.fx());
    y[i] = static_cast<float>((tile.v0 + i - camera.cy()) / camera.fy());
  }
  nearest_.fill(0.0f);
  front_.fill(-1);
  for (const std::uint32_t k : members_) {
    see(candidates[k], static_cast<std::int32_t>(k), x, y, nearest_.data(), front_.data());
  }
  facets_.clear();
  facet_of_.fill(0);
  std::int32_t before = -1, slot = 0;  // neighbours often see the same
  for (int v = 0; v < tile.v1 - tile.v0; ++v) {
    for (int p = v * kTile; p < v * kTile + tile.u1 - tile.u0; ++p) {
      if (front_[p] < 0) return false;
      if (front_[p] != before) {
        before = front_[p];
        const Facet* facet = &list.facet(candidates[before].triangle);
        slot = static_cast<std::int32_t>(std::find(facets_.begin(), facets_.end(), facet) - facets_.begin());
        if (slot == static_cast<std::int32_t>(facets_.size())) facets_.push_back(facet);
        if (facets_.size() > kMostFacets) return false;
      }
      facet_of_[p] = slot;
    }
  }
  return true;
}

}  // namespace aras_visual_servo_sim
