#pragma once

#include <vector>

#include "aras_visual_servo_camera/image/camera_intrinsics.hpp"

namespace aras_visual_servo_camera {

/** Normalised coordinates and area of each pixel, computed once per camera: lens distortion is undone here and nowhere
 *  else, without resampling the image. */
class PixelMap {
 public:
  explicit PixelMap(const CameraIntrinsics& intrinsics);

  const CameraIntrinsics& intrinsics() const { return intrinsics_; }
  int width() const { return intrinsics_.width(); }
  int height() const { return intrinsics_.height(); }
  /** True without distortion: x depends on u alone, y on v alone, area is constant. */
  bool separable() const { return !intrinsics_.distorted(); }

  struct Pixel {
    double x, y;  ///< [-]
    double area;  ///< area element d(x, y)/d(u, v) [1/px^2]; 0 where the lens model has no ray
  };
  Pixel at(int u, int v) const {
    if (separable()) return {x_of_u_[u], y_of_v_[v], area_};
    return pixels_[static_cast<std::size_t>(v) * width() + u];
  }

  /** Separable maps only. */
  const std::vector<double>& xOfU() const { return x_of_u_; }
  double yOfV(int v) const { return y_of_v_[v]; }
  double area() const { return area_; }

 private:
  CameraIntrinsics intrinsics_;
  double area_ = 0.0;
  std::vector<double> x_of_u_, y_of_v_;  // separable
  std::vector<Pixel> pixels_;            // distorted, row-major
};

}  // namespace aras_visual_servo_camera
