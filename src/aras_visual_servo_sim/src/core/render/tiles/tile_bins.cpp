#include "tile_bins.hpp"

#include <algorithm>
#include <cmath>

#include "render/view/held.hpp"

namespace aras_visual_servo_sim {
namespace {

/** Whether a triangle touches a square, known to lie in its bounding box: not if one edge has all of the square
 * outside. Errs by at most a thousandth of a pixel, on the side of touching. */
bool touches(const Vertex* t, float x0, float y0, float size) {
  const float area = (t[1].x - t[0].x) * (t[2].y - t[0].y) - (t[1].y - t[0].y) * (t[2].x - t[0].x);
  const float side = area < 0.0f ? -1.0f : 1.0f;
  for (int i = 0, j = 2; i < 3; j = i++) {
    const float dx = side * (t[i].x - t[j].x), dy = side * (t[i].y - t[j].y);
    // Corner of the square that lies farthest to the inner side of the edge from j to i.
    const float x = dy > 0.0f ? x0 : x0 + size, y = dx > 0.0f ? y0 + size : y0;
    constexpr float kMargin = 1e-3f;
    if (dx * (y - t[j].y) - dy * (x - t[j].x) < -kMargin * (std::abs(dx) + std::abs(dy))) return false;
  }
  return true;
}

}  // namespace

void TileBins::begin(int width, int height) {
  width_ = width;
  height_ = height;
  tiles_u_ = (width + kTile - 1) / kTile;
  tiles_v_ = (height + kTile - 1) / kTile;
  marked_.assign(std::size_t(tiles_u_) * tiles_v_, Mark::kNone);
}

void TileBins::markEverything() { std::fill(marked_.begin(), marked_.end(), Mark::kEverything); }

void TileBins::markEverything(const PixelBox& box) {
  if (box.empty()) return;
  for (int v = box.v0 / kTile; v <= (box.v1 - 1) / kTile; ++v) {
    std::fill(marked_.begin() + v * tiles_u_ + box.u0 / kTile,
              marked_.begin() + v * tiles_u_ + (box.u1 - 1) / kTile + 1, Mark::kEverything);
  }
}

void TileBins::markBodies(const TriangleList& triangles) {
  forEachTile(triangles, [this](int tile, std::uint32_t) { markBody(tile); });
}

/** Counts, running sums, entries. A facet that several cells see comes to a tile once. */
void TileBins::sort(const TriangleList& triangles) {
  constexpr std::uint32_t kNone = 0xffffffff;
  starts_.assign(marked_.size() + 1, 0);
  const auto forEach = [&](auto&& visit) {
    newest_.assign(marked_.size(), kNone);
    forEachTile(triangles, [&](int tile, std::uint32_t triangle) {
      if (marked_[tile] == Mark::kNone || newest_[tile] == triangle) return;
      newest_[tile] = triangle;
      visit(tile, triangle);
    });
  };
  forEach([&](int tile, std::uint32_t) { ++starts_[tile + 1]; });
  for (std::size_t k = 1; k < starts_.size(); ++k) starts_[k] += starts_[k - 1];
  triangles_.resize(starts_.back());
  next_.assign(starts_.begin(), starts_.end() - 1);
  forEach([&](int tile, std::uint32_t triangle) { triangles_[next_[tile]++] = triangle; });
}

PixelBox TileBins::pixels(int tile) const {
  const int u0 = tile % tiles_u_ * kTile, v0 = tile / tiles_u_ * kTile;
  return {u0, v0, std::min(u0 + kTile, width_), std::min(v0 + kTile, height_)};
}

template <typename Visit>
void TileBins::forEachTile(const TriangleList& triangles, const Visit& visit) const {
  for (const TriangleList::Span& span : triangles.spans()) {
    for (int u = span.first; u < span.last; ++u) visit(span.row * tiles_u_ + u, span.triangle);
  }
  const std::vector<Vertex>& vertices = triangles.vertices();
  for (std::size_t i = 0; i < vertices.size(); i += 3) {
    forEachTile(&vertices[i], [&](int tile) { visit(tile, static_cast<std::uint32_t>(i / 3)); });
  }
}

template <typename Visit>
void TileBins::forEachTile(const Vertex* triangle, const Visit& visit) const {
  const PixelBox box = tilesOf(triangle);
  const bool small = box.u1 - box.u0 <= 1 && box.v1 - box.v0 <= 1;
  for (int v = box.v0; v < box.v1; ++v) {
    for (int u = box.u0; u < box.u1; ++u) {
      if (small || touches(triangle, float(u * kTile), float(v * kTile), kTile)) visit(v * tiles_u_ + u);
    }
  }
}

/** Tiles that a triangle's bounding box touches. */
PixelBox TileBins::tilesOf(const Vertex* t) const {
  const auto tile = [](float x, int count) {
    return static_cast<int>(held(std::floor(x / kTile), -1.0f, float(count)));
  };
  return {std::max(0, tile(std::min({t[0].x, t[1].x, t[2].x}), tiles_u_)),
          std::max(0, tile(std::min({t[0].y, t[1].y, t[2].y}), tiles_v_)),
          std::min(tiles_u_, tile(std::max({t[0].x, t[1].x, t[2].x}), tiles_u_) + 1),
          std::min(tiles_v_, tile(std::max({t[0].y, t[1].y, t[2].y}), tiles_v_) + 1)};
}

}  // namespace aras_visual_servo_sim
