#include "tile_bins.hpp"

#include <algorithm>
#include <cmath>

#include "render/view/pixel_box.hpp"

namespace aras_visual_servo_sim {
namespace {

constexpr float kMargin = 1e-3f;  // [px] by which squares are taken to be larger: more than rounding

/** Narrows the squares first <= u < last of a row, from `top` to `bottom`, to those that are not wholly outside an
 * edge: its inner side is where dx (y - from.y) - dy (x - from.x) > 0. */
void narrow(const Vertex& from, float dx, float dy, float top, float bottom, int& first, int& last) {
  constexpr float kSize = TileBins::kTile;
  // Of the corners on the inner side of the edge, the least of what dy (x - from.x) may be and still touch it.
  const float most = dx * ((dx > 0.0f ? bottom : top) - from.y) + kMargin * (std::abs(dx) + std::abs(dy));
  if (dy == 0.0f) {
    if (most < 0.0f) last = first;
    return;
  }
  const float border = held(from.x + most / dy, -1e6f, 1e6f) / kSize;  // in squares
  if (dy > 0.0f) {
    last = std::min(last, static_cast<int>(std::floor(border)) + 1);  // the left side of a square must not be beyond
  } else {
    first = std::max(first, static_cast<int>(std::ceil(border)) - 1);  // nor its right side before
  }
}

}  // namespace

void TileBins::begin(int width, int height) {
  width_ = width;
  height_ = height;
  tiles_u_ = (width + kTile - 1) / kTile;
  tiles_v_ = (height + kTile - 1) / kTile;
  marked_.assign(std::size_t(tiles_u_) * tiles_v_, Mark::kNone);
  spans_.clear();
  added_ = 0;
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
  addSpans(triangles);
  forEachTile([this](int tile, std::uint32_t) { markBody(tile); });
}

/** Counts, running sums, entries. A facet that several cells see comes to a tile once. */
void TileBins::sort(const TriangleList& triangles) {
  constexpr std::uint32_t kNone = 0xffffffff;
  addSpans(triangles);
  starts_.assign(marked_.size() + 1, 0);
  const auto forEach = [&](auto&& visit) {
    newest_.assign(marked_.size(), kNone);
    forEachTile([&](int tile, std::uint32_t triangle) {
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
void TileBins::forEachTile(const Visit& visit) const {
  for (const TriangleList::Span& span : spans_) {
    for (int u = span.first; u < span.last; ++u) visit(span.row * tiles_u_ + u, span.triangle);
  }
}

/** Of triangles that were added to the list since the last time. */
void TileBins::addSpans(const TriangleList& triangles) {
  if (!triangles.isFlat()) {
    spans_.insert(spans_.end(), triangles.spans().begin() + added_, triangles.spans().end());
    added_ = triangles.spans().size();
    return;
  }
  for (; added_ < triangles.size(); ++added_) {
    addSpans(&triangles.vertices()[3 * added_], static_cast<std::uint32_t>(added_));
  }
}

void TileBins::addSpans(const Vertex* t, std::uint32_t index) {
  const PixelBox box = tilesOf(t);
  if (box.u1 - box.u0 <= 1 && box.v1 - box.v0 <= 1) {
    if (!box.empty()) spans_.emplace_back() = {index, box.v0, box.u0, box.u1};
    return;
  }
  const float area = (t[1].x - t[0].x) * (t[2].y - t[0].y) - (t[1].y - t[0].y) * (t[2].x - t[0].x);
  const float side = area < 0.0f ? -1.0f : 1.0f;
  for (int v = box.v0; v < box.v1; ++v) {
    int first = box.u0, last = box.u1;
    for (int i = 0, j = 2; i < 3; j = i++) {
      const float dx = side * (t[i].x - t[j].x), dy = side * (t[i].y - t[j].y);
      narrow(t[j], dx, dy, float(v * kTile), float((v + 1) * kTile), first, last);
    }
    if (first < last) spans_.emplace_back() = {index, v, first, last};
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
