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
 *  at the picture's border get the mean of the part that sees it. */
class TextureSampler {
 public:
  /** Writes the colours of the pixels in box that see the picture; others are undefined. */
  template <typename Value>
  void sample(const CameraModel& camera, const Pose& X_CM, const PlanarModel::Picture& picture, const PixelBox& box,
              ImageOf<Value>& out);

 private:
  static constexpr int kTile = 16;           ///< [px] block of pixels that share corners and edges
  static constexpr int kStride = kTile + 1;  ///< corners of a row of them
  static constexpr int kRows = 4;            ///< rows of texels that the largest pixel of a tile covers at least

  Eigen::Vector3d ray(double u, double v) const;
  Eigen::Vector3d onPicture(double u, double v) const { return T_ * ray(u, v); }
  template <typename Value>
  void sampleCenter(int u, int v, ImageOf<Value>& out) const;
  template <typename Value>
  void sampleTile(const PixelBox& box, ImageOf<Value>& out);
  const Texture::Level& levelOf(int channels, double& merged) const;
  template <int channels, typename Value>
  void integrateInside(const PixelBox& box, PictureMeans<channels, kTile>& means, ImageOf<Value>& out);
  template <int channels, typename Value>
  void integrateMany(const PixelBox& box, ImageOf<Value>& out) const;
  template <int channels, typename Value>
  void integrateBorder(const PixelBox& box, ImageOf<Value>& out);
  template <typename Value>
  void sampleRays(const PixelBox& box, ImageOf<Value>& out) const;
  template <typename Value>
  void write(const double* rgb, Value* pixel, Encoding encoding) const;

  const CameraModel* camera_ = nullptr;
  const Texture* texture_ = nullptr;
  Eigen::Matrix3d T_, pixels_;  ///< see PictureCorners
  PictureCorners<kTile> corners_;
  PictureMeans<1, kTile> grey_means_;
  PictureMeans<3, kTile> color_means_;
  std::array<double, 4 * kStride * kStride> across_, down_;  ///< integrals along edges to the right, downwards
};

}  // namespace aras_visual_servo_sim
