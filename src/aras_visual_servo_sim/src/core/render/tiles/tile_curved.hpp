#pragma once

#include <array>
#include <cstdint>

#include "render/curved/curved_list.hpp"
#include "render/pixels/pixel_samples.hpp"
#include "render/view/pixel_rays.hpp"
#include "tile_bins.hpp"

namespace aras_visual_servo_sim {

/** Which pixels of a tile see a curved patch, and between which depths. */
class TileCurved {
 public:
  enum class Cover : char { kNone, kPart, kWhole };

  /** @param rays    of the tile's pixels, kTile to a row
   *  @param entry   index of the patch in its list
   *  @return false if no pixel sees it */
  bool set(const CameraModel& camera, const CurvedPatch& patch, std::uint32_t entry, const PixelBox& tile,
           const PixelRays* rays);

  std::uint32_t entry;
  std::array<Cover, TileBins::kTile * TileBins::kTile> cover;
  std::array<float, TileBins::kTile * TileBins::kTile> nearest, farthest;  ///< bounds of near_m / Z in each pixel
};

/** 1 / s of what a ray sees of a patch at s times the ray; 0 where it sees nothing between near_m and far_m. */
double nearnessAt(const CameraModel& camera, const CurvedPatch& patch, const Eigen::Vector3d& ray);

/** A patch about a pixel, for PixelSamples. */
PixelSamples::Curved samplesOf(const CameraModel& camera, const CurvedPatch& patch, const PixelRays& rays);

}  // namespace aras_visual_servo_sim
