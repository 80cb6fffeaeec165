#pragma once

#include <array>

#include "aras_visual_servo_sim/camera/camera_model.hpp"
#include "render/picture/picture_means.hpp"
#include "render/triangles/facet.hpp"
#include "tile_bins.hpp"

namespace aras_visual_servo_sim {

/** What the pixels of a tile see of a facet's picture. */
class TileTexture {
 public:
  static constexpr int kTile = TileBins::kTile, kPixels = kTile * kTile;
  using Color = SumLanes<3>::Value;  ///< red, green, blue, 0 .. 255, and something

  /** @param facet  has a texture, and its plane is taken to cover the tile
   *  @return false if this has to be found pixel by pixel: the plane's horizon is near, or pixels see many texels */
  bool look(const CameraModel& camera, const Facet& facet, const PixelBox& tile);

  /** Colour of each pixel, row by row of kTile: means over their squares, or for a camera that samples centres, texels.
   */
  const Color* colors() const { return colors_; }

 private:
  bool lookAtCenters(const CameraModel& camera, const MeshPicture& picture, const PixelBox& tile);

  Eigen::Matrix3d T_, pixels_;  // see PictureCorners
  double least_ = 0.0;
  PictureCorners<kTile> corners_;
  PictureMeans<3, kTile> means_;
  std::array<Color, kPixels> texels_;
  const Color* colors_ = nullptr;
};

}  // namespace aras_visual_servo_sim
