#pragma once

#include <vector>

#include "aras_visual_servo_sim/camera/camera_model.hpp"
#include "aras_visual_servo_sim/image/image.hpp"
#include "tile_triangle.hpp"

namespace aras_visual_servo_sim {

/** The candidate that covers every pixel of a tile and lies in front of all others there; null if there is none, or if
 *  it cannot be told from the tile's corners, through a lens from the cone of its rays. */
const TileTriangle* wholeFront(const CameraModel& camera, const TriangleList& list,
                               const std::vector<TileTriangle>& candidates, const PixelBox& tile, const RayCone& cone);

/** Paints every pixel of a tile with the colours of a facet that covers it, as Facet::color has them for the ray
 *  through its middle, texture left out. */
template <typename Value>
void shadeTile(const CameraModel& camera, const Facet& facet, const PixelBox& tile, ImageOf<Value>& image);

}  // namespace aras_visual_servo_sim
