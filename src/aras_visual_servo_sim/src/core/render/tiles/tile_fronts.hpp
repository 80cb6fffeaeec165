#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "aras_visual_servo_sim/camera/camera_model.hpp"
#include "tile_bins.hpp"
#include "tile_sight.hpp"

namespace aras_visual_servo_sim {

/** Difference between triangles of one surface that counts as an edge [grey levels]. */
inline constexpr float kCrease = 24.0f;

/** Which triangle each pixel of a tile sees, in tiles where what its middle sees is all that matters: those that see
 * one surface only, without its edges, and all tiles of cameras that sample centres. */
class TileFronts {
 public:
  static constexpr int kTile = TileBins::kTile, kPixels = kTile * kTile;

  /** @param candidates  of the tile @param cone  its rays, through a lens
   *  @return false if some pixel sees an edge or two surfaces or nothing, or if that cannot be told from the whole
   * tile: pixels are to be looked at one by one */
  bool find(const CameraModel& camera, const TriangleList& list, const std::vector<TileTriangle>& candidates,
            const PixelBox& tile, const RayCone& cone);

  /** What is seen, each facet once. */
  const std::vector<const Facet*>& facets() const { return facets_; }
  /** Index into facets() of each pixel, row by row of kTile; of no meaning if there is but one. */
  const std::int32_t* facetOf() const { return facet_of_.data(); }

 private:
  struct Depths {
    float farthest, nearest;  ///< of near_m / Z over the tile
  };
  static Depths depthsOf(const TileTriangle& t, const CameraModel& camera, const PixelBox& tile);
  bool findOne(const CameraModel& camera, const TriangleList& list, const std::vector<TileTriangle>& candidates,
               const PixelBox& tile, const RayCone& cone);
  bool collectSurface(const CameraModel& camera, const TriangleList& list, const std::vector<TileTriangle>& candidates,
                      const PixelBox& tile);
  bool select(const CameraModel& camera, const TriangleList& list, const std::vector<TileTriangle>& candidates,
              const PixelBox& tile);

  std::vector<const Facet*> facets_;
  std::vector<std::uint32_t> members_;  // scratch: candidates that pixels may see
  std::array<std::int32_t, kPixels> front_, facet_of_;
  std::array<float, kPixels> nearest_;
};

}  // namespace aras_visual_servo_sim
