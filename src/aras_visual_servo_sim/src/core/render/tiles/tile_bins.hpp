#pragma once

#include <cstdint>
#include <vector>

#include "aras_visual_servo_sim/camera/camera_model.hpp"
#include "render/coverage/coverage_rasterizer.hpp"
#include "render/triangles/triangle_list.hpp"

namespace aras_visual_servo_sim {

/** Square tiles of an image: which of them are to be painted, and which triangles may touch each of these. */
class TileBins {
 public:
  static constexpr int kTile = CameraModel::kBlock;  ///< [px]
  /** What a tile needs. */
  enum class Mark : char {
    kNone,
    kBodies,     ///< pixels that see a body; the others stay as they are
    kEverything  ///< every pixel
  };

  /** Starts a frame: no tile is marked. */
  void begin(int width, int height);
  void markEverything();
  void markEverything(const PixelBox& box);
  /** Marks what the triangles may touch for bodies. */
  void markBodies(const TriangleList& triangles);
  /** Marks a tile for a body. */
  void markBody(int tile) {
    if (marked_[tile] == Mark::kNone) marked_[tile] = Mark::kBodies;
  }
  /** Sorts triangles into the marked tiles. */
  void sort(const TriangleList& triangles);

  int width() const { return width_; }
  int height() const { return height_; }
  int tiles() const { return static_cast<int>(marked_.size()); }
  Mark mark(int tile) const { return marked_[tile]; }
  PixelBox pixels(int tile) const;
  /** Triangles of a marked tile after sort(), in their order. */
  const std::uint32_t* begin(int tile) const { return triangles_.data() + starts_[tile]; }
  const std::uint32_t* end(int tile) const { return triangles_.data() + starts_[tile + 1]; }

 private:
  void addSpans(const TriangleList& triangles);
  void addSpans(const Vertex* triangle, std::uint32_t index);
  template <typename Visit>
  void forEachTile(const Visit& visit) const;
  PixelBox tilesOf(const Vertex* triangle) const;

  int width_ = 0, height_ = 0, tiles_u_ = 0, tiles_v_ = 0;
  std::vector<Mark> marked_;
  std::vector<TriangleList::Span> spans_;  // of triangles 0 .. added_ - 1
  std::size_t added_ = 0;                  // through a lens: spans of the list
  std::vector<std::uint32_t> starts_, next_, triangles_, newest_;
};

}  // namespace aras_visual_servo_sim
