#pragma once

#include <vector>

#include "aras_visual_servo_camera/image/camera_intrinsics.hpp"

namespace aras_visual_servo_camera {

/** Normalised coordinates and area of each pixel, computed once per camera: lens distortion is undone here and nowhere
 *  else, without resampling the image. */
class PixelMap {
 public:
  /** @param rays  whether rays() are asked for, as far as a fisheye sees */
  explicit PixelMap(const CameraIntrinsics& intrinsics, bool rays = false);

  const CameraIntrinsics& intrinsics() const { return intrinsics_; }
  int width() const { return intrinsics_.width(); }
  int height() const { return intrinsics_.height(); }
  /** True without distortion where every pixel has a ray: x depends on u alone, y on v alone, area is constant. */
  bool separable() const { return pixels_.empty(); }

  struct Pixel {
    double x, y;  ///< [-]
    double area;  ///< area element d(x, y)/d(u, v) [1/px^2]; 0 where the lens model has no ray
  };
  Pixel at(int u, int v) const {
    if (separable()) return {x_of_u_[u], y_of_v_[v], area_};
    return pixels_[static_cast<std::size_t>(v) * width() + u];
  }

  /** The same at (u + du, v + dv), each at most 1/2: from a pixel to its neighbours, it changes linearly. */
  Pixel at(int u, int v, double du, double dv) const {
    const Pixel p = at(u, v);
    if (separable()) return {p.x + du / intrinsics_.fx(), p.y + dv / intrinsics_.fy(), p.area};
    const int right = u + 1 < width() ? 1 : -1, down = v + 1 < height() ? 1 : -1;
    const Pixel a = at(u + right, v), b = at(u, v + down);
    if (p.area == 0.0 || a.area == 0.0 || b.area == 0.0) return p;
    const auto between = [&](double Pixel::*value) {
      return p.*value + right * du * (a.*value - p.*value) + down * dv * (b.*value - p.*value);
    };
    return {between(&Pixel::x), between(&Pixel::y), between(&Pixel::area)};
  }

  /** Whether the pixel has a ray: one with coordinates or, in a map with rays,
   * any. */
  bool sees(int u, int v) const {
    if (rays_.empty()) return at(u, v).area > 0.0;
    return rays_[static_cast<std::size_t>(v) * width() + u].solid_angle > 0.0;
  }
  /** Maps with rays only. */
  const CameraIntrinsics::Ray& ray(int u, int v) const { return rays_[static_cast<std::size_t>(v) * width() + u]; }

  /** Separable maps only. */
  const std::vector<double>& xOfU() const { return x_of_u_; }
  double yOfV(int v) const { return y_of_v_[v]; }
  double area() const { return area_; }

 private:
  CameraIntrinsics intrinsics_;
  double area_ = 0.0;
  std::vector<double> x_of_u_, y_of_v_;  // separable
  std::vector<Pixel> pixels_;            // else, row-major
  std::vector<CameraIntrinsics::Ray> rays_;
};

}  // namespace aras_visual_servo_camera
