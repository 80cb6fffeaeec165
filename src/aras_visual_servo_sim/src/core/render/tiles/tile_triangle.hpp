#pragma once

#include <array>
#include <cstdint>

#include "render/coverage/coverage_rasterizer.hpp"
#include "render/triangles/triangle_list.hpp"

namespace aras_visual_servo_sim {

/** A projected triangle about a tile of the image: its edges as half-planes a x + b y + c >= least, x and y from the
 *  tile's corner [px], and its plane, near_m / Z = plane . ray + bias. */
struct TileTriangle {
  std::uint32_t triangle;  ///< index into the list
  std::uint32_t surface;
  std::array<float, 3> a, b, c, least;
  std::array<bool, 3> seam;  ///< of each edge: see Vertex
  float plane[3], bias;

  /** @param tile  pixels of the tile @return false if the triangle has no area */
  bool set(const TriangleList& list, std::uint32_t index, double near_m, const PixelBox& tile);
};

}  // namespace aras_visual_servo_sim
