#pragma once

#include <Eigen/Core>
#include <array>

#include "aras_visual_servo_sim/camera/camera_model.hpp"
#include "picture_window.hpp"
#include "render/view/pixel_box.hpp"

namespace aras_visual_servo_sim {

/** Where the corners of a tile's pixels lie on a picture, in texels: s to the right, t down.
 *
 *  A ray (in C) sees (s, t) = m.head<2>() / m.z() with m = T * ray; m.z() > 0 in front of the camera.
 *  @tparam size  pixels of the tile each way; corners of a narrower tile end in copies of its last ones */
template <int size>
class PictureCorners {
 public:
  static constexpr int kStride = size + 1, kCount = kStride * kStride;

  /** @param pixels_to_picture  without a lens: T times the rays of pixel coordinates (u, v, 1)
   *  @return false if some corner does not see the plane, or with its T (any length) at less than `least` of m.z() */
  bool project(const CameraModel& camera, const Eigen::Matrix3d& T, const Eigen::Matrix3d& pixels_to_picture,
               const PixelBox& tile, double least = 0.0);

  int columns() const { return columns_; }
  int rows() const { return rows_; }
  double s(int i, int j) const { return s_[j * kStride + i]; }
  double t(int i, int j) const { return t_[j * kStride + i]; }
  Eigen::Vector2d at(int i, int j) const { return {s(i, j), t(i, j)}; }
  const double* s() const { return s_.data(); }
  const double* t() const { return t_.data(); }
  /** Least and greatest coordinates. */
  const Eigen::Array2d& low() const { return low_; }
  const Eigen::Array2d& high() const { return high_; }
  /** The most that an edge of a pixel extends along s and along t [texels], at least 1. */
  const Eigen::Array2d& longest() const { return longest_; }

 private:
  void measure(bool straight);

  int columns_ = 0, rows_ = 0;
  std::array<double, kCount> s_, t_;
  Eigen::Array2d low_, high_, longest_;
};

/** Pixel coordinates to rays, without a lens. */
Eigen::Matrix3d raysOfPixels(const CameraModel& camera);

/** Means of a picture over the pixels of a tile, each a quadrangle on it with straight edges.
 *
 *  By Green's theorem the integral of the texels over a quadrangle is that of their running sums along its edges.
 *  An edge is cut where it passes from texel to texel; between cuts the running sum is linear, so that the middle of
 *  each piece gives its mean. Eight or sixteen edges are cut at a time, all of them into as many pieces as the one that
 *  needs most: some have no length. This is exact but for the rounding of single precision. */
template <int channels, int size>
class PictureMeans {
 public:
  using Value = typename SumLanes<channels>::Value;

  /** @return false if pixels see too many texels, or a tile next to none: this is no way for them then */
  bool integrate(const PictureCorners<size>& corners, const Texture& texture, Wrap wrap_s, Wrap wrap_t);

  /** Mean colour of each pixel, 0 .. 255, row by row of `size`. */
  const Value* means() const { return means_.data(); }

 private:
  static constexpr int kStride = PictureCorners<size>::kStride, kCount = PictureCorners<size>::kCount;
  using Values = std::array<Value, kCount>;

  bool integrateEdges(const float* xa, const float* ya, const float* xb, const float* yb, int count, Value* integrals);

  PictureWindow<channels> window_;
  std::array<float, kCount> x_, y_, x_turned_, y_turned_;  // of the corners, row by row and column by column
  Values across_, down_;  // integrals along edges to the right, row by row, and downwards, column by column
  std::array<Value, std::size_t(size) * size> means_;
};

}  // namespace aras_visual_servo_sim
