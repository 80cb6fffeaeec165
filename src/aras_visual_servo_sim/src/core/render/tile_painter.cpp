#include "tile_painter.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>

#include "pixel_color.hpp"
#include "triangle_list.hpp"

namespace aras_visual_servo_sim {
namespace {

constexpr int kSlotSize = TilePainter::kTile * TilePainter::kSamples;  // [samples]
constexpr int kSlotsAcross = 8;                                        // the atlas is 512 x 512 samples
constexpr int kSlots = kSlotsAcross * kSlotsAcross;
constexpr int kCrease = 24;  // [grey levels] between neighbours on one object that count as an edge

struct Bytes {
  std::uint8_t r, g, b, a;
};

Bytes bytesOf(std::uint32_t pixel) {
  Bytes bytes;
  std::memcpy(&bytes, &pixel, sizeof bytes);
  return bytes;
}

bool differ(std::uint32_t p, std::uint32_t q) {
  if (p == q) return false;
  const Bytes a = bytesOf(p), b = bytesOf(q);
  return a.a != b.a || std::abs(a.r - b.r) > kCrease || std::abs(a.g - b.g) > kCrease || std::abs(a.b - b.b) > kCrease;
}

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

void write(const std::array<std::uint8_t, 3>& pixel, bool color, std::uint8_t* out) {
  out[0] = pixel[0];
  if (!color) return;
  out[1] = pixel[1];
  out[2] = pixel[2];
}

Vertex between(const Vertex& a, const Vertex& b, float t) {
  Vertex vertex{a.x + t * (b.x - a.x), a.y + t * (b.y - a.y), a.z + t * (b.z - a.z), a.rgba};
  for (int c = 0; c < 3; ++c) {
    vertex.rgba[c] = static_cast<std::uint8_t>(a.rgba[c] + t * (float(b.rgba[c]) - float(a.rgba[c])) + 0.5f);
  }
  return vertex;
}

/** A triangle being cut to a square: up to seven corners. */
struct Piece {
  std::array<Vertex, 8> corners;
  int count = 0;
};

/** Keeps what has side * (x or y) >= side * limit; crossings are computed from the inner end, alike for neighbours. */
void cutPiece(Piece& piece, float Vertex::*axis, float limit, float side) {
  Piece kept;
  for (int i = 0, j = piece.count - 1; i < piece.count; j = i++) {
    const Vertex &before = piece.corners[j], &here = piece.corners[i];
    const float d0 = side * (before.*axis - limit), d1 = side * (here.*axis - limit);
    if ((d0 >= 0.0f) != (d1 >= 0.0f)) {
      Vertex crossing = d1 >= 0.0f ? between(here, before, d1 / (d1 - d0)) : between(before, here, d0 / (d0 - d1));
      crossing.*axis = limit;
      kept.corners[kept.count++] = crossing;
    }
    if (d1 >= 0.0f) kept.corners[kept.count++] = here;
  }
  piece = kept;
}

}  // namespace

void TilePainter::begin(int width, int height) {
  width_ = width;
  height_ = height;
  tiles_u_ = (width + kTile - 1) / kTile;
  tiles_v_ = (height + kTile - 1) / kTile;
  marked_.assign(std::size_t(tiles_u_) * tiles_v_, 0);
  marked_tiles_ = supersampled_tiles_ = 0;
}

void TilePainter::markAll() { std::fill(marked_.begin(), marked_.end(), 1); }

void TilePainter::mark(const PixelBox& box) {
  if (box.empty()) return;
  for (int v = box.v0 / kTile; v <= (box.v1 - 1) / kTile; ++v) {
    std::fill(marked_.begin() + v * tiles_u_ + box.u0 / kTile,
              marked_.begin() + v * tiles_u_ + (box.u1 - 1) / kTile + 1, 1);
  }
}

void TilePainter::mark(const std::vector<Vertex>& vertices) {
  for (std::size_t i = 0; i < vertices.size(); i += 3) {
    forEachTile(&vertices[i], [this](int tile) { marked_[tile] = 1; });
  }
}

template <typename Visit>
void TilePainter::forEachTile(const Vertex* triangle, const Visit& visit) const {
  const PixelBox box = tilesOf(triangle);
  const bool small = box.u1 - box.u0 <= 1 && box.v1 - box.v0 <= 1;
  for (int v = box.v0; v < box.v1; ++v) {
    for (int u = box.u0; u < box.u1; ++u) {
      if (small || touches(triangle, float(u * kTile), float(v * kTile), kTile)) visit(v * tiles_u_ + u);
    }
  }
}

/** Tiles that a triangle's bounding box touches. */
PixelBox TilePainter::tilesOf(const Vertex* t) const {
  const auto tile = [](float x, int count) {
    return static_cast<int>(std::clamp(std::floor(x / kTile), -1.0f, float(count)));
  };
  return {std::max(0, tile(std::min({t[0].x, t[1].x, t[2].x}), tiles_u_)),
          std::max(0, tile(std::min({t[0].y, t[1].y, t[2].y}), tiles_v_)),
          std::min(tiles_u_, tile(std::max({t[0].x, t[1].x, t[2].x}), tiles_u_) + 1),
          std::min(tiles_v_, tile(std::max({t[0].y, t[1].y, t[2].y}), tiles_v_) + 1)};
}

const Image* TilePainter::pictureOf(std::uint8_t number) const {
  const std::size_t index = std::size_t(number) - TriangleList::pictureNumber(0);
  return index < pictures_->size() ? &(*pictures_)[index] : nullptr;
}

void TilePainter::paint(const std::vector<Vertex>& vertices, const Rgb& background, const std::vector<Image>& pictures,
                        bool supersample, Image& image) {
  pictures_ = &pictures;
  std::unique_ptr<OsmesaCanvas>& canvas = canvases_[{width_, height_}];
  if (!canvas) canvas = std::make_unique<OsmesaCanvas>(width_, height_);
  const std::uint32_t* picture = canvas->draw(vertices, background);
  std::vector<int> sampled;
  for (int v = 0; v < tiles_v_; ++v) {
    for (int u = 0; u < tiles_u_; ++u) {
      if (!marked_[std::size_t(v) * tiles_u_ + u]) continue;
      ++marked_tiles_;
      if (supersample && showsEdge(picture, u, v)) {
        sampled.push_back(v * tiles_u_ + u);
      } else {
        copyTile(picture, u, v, image);
      }
    }
  }
  supersampled_tiles_ = static_cast<int>(sampled.size());
  if (sampled.empty()) return;
  sortIntoTiles(vertices, sampled);
  for (std::size_t first = 0; first < sampled.size(); first += kSlots) {
    paintAtlas(vertices, sampled, first, std::min(sampled.size(), first + kSlots), background, image);
  }
}

/** Whether a pixel of the tile differs from a neighbour, in the tile or beside it. */
bool TilePainter::showsEdge(const std::uint32_t* picture, int tile_u, int tile_v) const {
  const int u0 = std::max(0, tile_u * kTile - 1), u1 = std::min(width_ - 1, (tile_u + 1) * kTile);
  const int v0 = std::max(0, tile_v * kTile - 1), v1 = std::min(height_ - 1, (tile_v + 1) * kTile);
  for (int v = v0; v <= v1; ++v) {
    const std::uint32_t* row = picture + std::size_t(v) * width_;
    for (int u = u0; u <= u1; ++u) {
      if ((u < u1 && differ(row[u], row[u + 1])) || (v < v1 && differ(row[u], row[u + width_]))) return true;
    }
  }
  return false;
}

void TilePainter::copyTile(const std::uint32_t* picture, int tile_u, int tile_v, Image& image) const {
  const int channels = image.channels();
  for (int v = tile_v * kTile; v < std::min(height_, (tile_v + 1) * kTile); ++v) {
    std::uint8_t* row = image.pixel(0, v);
    for (int u = tile_u * kTile; u < std::min(width_, (tile_u + 1) * kTile); ++u) {
      const Bytes bytes = bytesOf(picture[std::size_t(v) * width_ + u]);
      if (const Image* seen = pictureOf(bytes.a)) {
        std::copy_n(seen->pixel(u, v), channels, row + u * channels);
        continue;
      }
      write(pixelOf({bytes.r, bytes.g, bytes.b}, image.encoding), channels == 3, row + u * channels);
    }
  }
}

/** Lists for each tile to be sampled the triangles that may touch it: counts, running sums, entries. */
void TilePainter::sortIntoTiles(const std::vector<Vertex>& vertices, const std::vector<int>& tiles) {
  slot_of_tile_.assign(marked_.size(), -1);
  for (std::size_t k = 0; k < tiles.size(); ++k) slot_of_tile_[tiles[k]] = static_cast<int>(k);
  starts_.assign(tiles.size() + 1, 0);
  const auto forEach = [&](auto&& visit) {
    for (std::size_t i = 0; i < vertices.size(); i += 3) {
      forEachTile(&vertices[i], [&](int tile) {
        const int slot = slot_of_tile_[tile];
        if (slot >= 0) visit(static_cast<std::size_t>(slot), static_cast<std::uint32_t>(i));
      });
    }
  };
  forEach([&](std::size_t slot, std::uint32_t) { ++starts_[slot + 1]; });
  for (std::size_t k = 1; k < starts_.size(); ++k) starts_[k] += starts_[k - 1];
  triangles_.resize(starts_.back());
  std::vector<std::uint32_t> next(starts_.begin(), starts_.end() - 1);
  forEach([&](std::size_t slot, std::uint32_t triangle) { triangles_[next[slot]++] = triangle; });
}

void TilePainter::paintAtlas(const std::vector<Vertex>& vertices, const std::vector<int>& tiles, std::size_t first,
                             std::size_t last, const Rgb& background, Image& image) {
  if (!atlas_) atlas_ = std::make_unique<OsmesaCanvas>(kSlotsAcross * kSlotSize, kSlotsAcross * kSlotSize);
  atlas_vertices_.clear();
  for (std::size_t k = first; k < last; ++k) {
    for (std::uint32_t i = starts_[k]; i < starts_[k + 1]; ++i) {
      addToAtlas(&vertices[triangles_[i]], tiles[k], static_cast<int>(k - first));
    }
  }
  const std::uint32_t* atlas = atlas_->draw(atlas_vertices_, background);
  for (std::size_t k = first; k < last; ++k) filterTile(atlas, static_cast<int>(k - first), tiles[k], image);
}

void TilePainter::addToAtlas(const Vertex* triangle, int tile, int slot) {
  const float x0 = static_cast<float>(tile % tiles_u_ * kTile), x1 = x0 + kTile;
  const float y0 = static_cast<float>(tile / tiles_u_ * kTile), y1 = y0 + kTile;
  Piece piece;
  piece.count = 3;
  std::copy(triangle, triangle + 3, piece.corners.begin());
  const auto sticksOut = [&](float Vertex::*axis, float low, float high) {
    return std::any_of(triangle, triangle + 3, [&](const Vertex& v) { return v.*axis < low || v.*axis > high; });
  };
  if (sticksOut(&Vertex::x, x0, x1)) {
    cutPiece(piece, &Vertex::x, x0, 1.0f);
    cutPiece(piece, &Vertex::x, x1, -1.0f);
  }
  if (sticksOut(&Vertex::y, y0, y1)) {
    cutPiece(piece, &Vertex::y, y0, 1.0f);
    cutPiece(piece, &Vertex::y, y1, -1.0f);
  }
  const float slot_x = static_cast<float>(slot % kSlotsAcross * kSlotSize);
  const float slot_y = static_cast<float>(slot / kSlotsAcross * kSlotSize);
  for (int i = 0; i < piece.count; ++i) {
    piece.corners[i].x = (piece.corners[i].x - x0) * kSamples + slot_x;
    piece.corners[i].y = (piece.corners[i].y - y0) * kSamples + slot_y;
  }
  for (int i = 2; i < piece.count; ++i) {
    atlas_vertices_.insert(atlas_vertices_.end(), {piece.corners[0], piece.corners[i - 1], piece.corners[i]});
  }
}

/** Adds the share of the pictures in the mean of a pixel's samples. @param rgb  red green blue, of any encoding */
void TilePainter::addPictures(const std::uint32_t* samples, int u, int v, double* rgb) const {
  const int atlas_width = kSlotsAcross * kSlotSize;
  std::array<int, 256> counts{};
  for (int j = 0; j < kSamples; ++j) {
    for (int i = 0; i < kSamples; ++i) ++counts[bytesOf(samples[j * atlas_width + i]).a];
  }
  for (std::size_t k = 0; k < pictures_->size(); ++k) {
    const int count = counts[TriangleList::pictureNumber(static_cast<int>(k))];
    if (count == 0) continue;
    const Image& picture = (*pictures_)[k];
    const std::uint8_t* pixel = picture.pixel(u, v);
    const double share = double(count) / (kSamples * kSamples);
    const bool grey = picture.channels() == 1, bgr = picture.encoding == Encoding::kBgr8;
    for (int c = 0; c < 3; ++c) rgb[c] += share * pixel[grey ? 0 : bgr ? 2 - c : c];
  }
}

/** Mean of the samples of each pixel. */
void TilePainter::filterTile(const std::uint32_t* atlas, int slot, int tile, Image& image) const {
  const int atlas_width = kSlotsAcross * kSlotSize;
  const int u0 = tile % tiles_u_ * kTile, v0 = tile / tiles_u_ * kTile;
  const std::uint32_t* corner =
      atlas + std::size_t(slot / kSlotsAcross) * kSlotSize * atlas_width + std::size_t(slot % kSlotsAcross) * kSlotSize;
  constexpr std::uint32_t kPairs = 0x00ff00ff;  // two channels side by side, room for 64 sums of 8 bits each
  constexpr int kCount = kSamples * kSamples;
  for (int v = v0; v < std::min(height_, v0 + kTile); ++v) {
    for (int u = u0; u < std::min(width_, u0 + kTile); ++u) {
      const std::uint32_t* samples = corner + std::size_t(v - v0) * kSamples * atlas_width + (u - u0) * kSamples;
      std::uint32_t even = 0, odd = 0;
      for (int j = 0; j < kSamples; ++j, samples += atlas_width) {
        for (int i = 0; i < kSamples; ++i) {
          even += samples[i] & kPairs;
          odd += (samples[i] >> 8) & kPairs;
        }
      }
      // Little-endian: r lowest.
      double rgb[3] = {double(even & 0xffff) / kCount, double(odd & 0xffff) / kCount, double(even >> 16) / kCount};
      if (!pictures_->empty())
        addPictures(corner + std::size_t(v - v0) * kSamples * atlas_width + (u - u0) * kSamples, u, v, rgb);
      const auto byte = [](double x) { return static_cast<std::uint8_t>(x + 0.5); };
      if (image.encoding == Encoding::kMono8) {
        *image.pixel(u, v) = greyOf(rgb[0], rgb[1], rgb[2]);
      } else {
        write(pixelOf({byte(rgb[0]), byte(rgb[1]), byte(rgb[2])}, image.encoding), true, image.pixel(u, v));
      }
    }
  }
}

}  // namespace aras_visual_servo_sim
