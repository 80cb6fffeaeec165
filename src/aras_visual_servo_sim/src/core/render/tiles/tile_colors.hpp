#pragma once

#include <array>
#include <cstdint>

#include "aras_visual_servo_sim/camera/camera_model.hpp"
#include "aras_visual_servo_sim/image/image.hpp"
#include "render/picture/picture_means.hpp"
#include "render/triangles/facet.hpp"
#include "tile_bins.hpp"

namespace aras_visual_servo_sim {

/** Colours of a tile's pixels, 0 .. 255, row by row. */
class TileColors {
 public:
  static constexpr int kTile = TileBins::kTile, kPixels = kTile * kTile;

  /** Those of a facet that covers the tile, as Facet::color has them for the rays through the pixels' middles, texture
   *  left out. Pixels beyond the image's border get any numbers. */
  void shade(const CameraModel& camera, const Facet& facet, const PixelBox& tile);
  /** Multiplies them by those of a picture, 255 being one. */
  void multiply(const SumLanes<3>::Value* picture);
  /** Takes the pixels that see facet `index` from others. @param facet_of  of each pixel */
  void take(const TileColors& others, const std::int32_t* facet_of, std::int32_t index);
  /** Rounds them to the values of an image. */
  template <typename Value>
  void write(const PixelBox& tile, ImageOf<Value>& image) const;

 private:
  void shadeFlat(const CameraModel& camera, const Facet& facet, const PixelBox& tile);
  void shadeBent(const CameraModel& camera, const Facet& facet, const PixelBox& tile);

  alignas(32) double red_[kPixels]{}, green_[kPixels]{}, blue_[kPixels]{};
};

/** Paints a tile with one colour. */
template <typename Value>
void paintTileWith(const Eigen::Vector3f& rgb, const PixelBox& tile, ImageOf<Value>& image);

/** What the pixels of a tile see of a facet's picture. */
class TileTexture {
 public:
  static constexpr int kTile = TileBins::kTile, kPixels = kTile * kTile;
  using Color = SumLanes<3>::Value;  ///< red, green, blue, 0 .. 255, and something

  /** @param facet  has a texture, and its plane is taken to cover the tile
   *  @return false if this has to be found pixel by pixel: the plane's horizon is near, or pixels see many texels */
  bool look(const CameraModel& camera, const Facet& facet, const PixelBox& tile);

  /** Colour of each pixel, row by row of kTile: means over squares, or texels for a camera that samples centres. */
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
