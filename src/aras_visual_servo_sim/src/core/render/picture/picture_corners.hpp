#pragma once

#include <Eigen/Core>
#include <array>

#include "aras_visual_servo_sim/camera/camera_model.hpp"
#include "render/coverage/coverage_rasterizer.hpp"

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

}  // namespace aras_visual_servo_sim
