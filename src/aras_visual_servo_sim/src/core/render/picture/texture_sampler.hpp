#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "aras_visual_servo_sim/camera/camera_model.hpp"
#include "aras_visual_servo_sim/scene/scene.hpp"
#include "picture_means.hpp"
#include "render/coverage/coverage_rasterizer.hpp"

namespace aras_visual_servo_sim {

/** Colours of pixels that look at a planar model's picture.
 *
 *  The square of a pixel is a quadrangle on the picture; the integral of the texels over it is, by Green's theorem, the
 *  integral of their running sum along its four edges, and neighbouring pixels share edges. Edges are taken as straight
 *  on the picture and the scale as constant over a pixel, which perspective and lenses spoil by second-order terms.
 *  Where a pixel covers many texel rows, rows are merged first (Texture::Level) so that at least kRows remain. Pixels
 *  at the picture's border get the mean of the part that sees it (texture_border.cpp). */
class TextureSampler {
 public:
  /** Writes the colours of the pixels in box that see the picture; others are undefined.
   *  @param X_CM  pose of the model in the camera's frame */
  template <typename Value>
  void sample(const CameraModel& camera, const Pose& X_CM, const PlanarModel::Picture& picture, const PixelBox& box,
              ImageOf<Value>& out);

 private:
  static constexpr int kTile = 16;           ///< [px] block of pixels that share corners and edges
  static constexpr int kStride = kTile + 1;  ///< corners of a row of them
  static constexpr int kRows =
      4;  ///< rows of texels that the largest pixel of a tile still covers, if there are as many

  using Corners = PictureCorners<kTile>;
  struct Tile {
    PixelBox box;
    bool border = false;  ///< some corner lies outside the picture; or the tile sees next to nothing of it
    bool seen = true;     ///< some pixel may see the picture
  };
  Eigen::Vector3d ray(double u, double v) const;
  Eigen::Vector3d onPicture(double u, double v) const { return T_ * ray(u, v); }
  template <typename Value>
  void sampleCenters(const PixelBox& box, ImageOf<Value>& out) const;
  template <typename Value>
  void sampleCenter(int u, int v, ImageOf<Value>& out) const;
  template <typename Value>
  void sampleTile(const PixelBox& box, ImageOf<Value>& out);
  const Texture::Level& levelOf(int channels, double& merged) const;
  template <int channels, typename Value>
  void integrateInside(const Tile& tile, PictureMeans<channels, kTile>& means, ImageOf<Value>& out);
  template <int channels, typename Value>
  void integrateMany(const Tile& tile, ImageOf<Value>& out) const;
  template <int channels, typename Value>
  void integrateBorder(const Tile& tile, ImageOf<Value>& out);
  template <typename Value>
  void sampleRays(const PixelBox& box, ImageOf<Value>& out) const;
  template <typename Value>
  void write(const double* rgb, Value* pixel, Encoding encoding) const;

  const CameraModel* camera_ = nullptr;
  const Texture* texture_ = nullptr;
  Eigen::Matrix3d T_,
      pixels_;  ///< see PictureCorners: rays, and without a lens pixel coordinates, to texture coordinates
  Corners corners_;
  PictureMeans<1, kTile> grey_means_;
  PictureMeans<3, kTile> color_means_;
  std::array<double, 4 * kStride * kStride> across_, down_;  ///< integrals along edges to the right, downwards
};

}  // namespace aras_visual_servo_sim
