#pragma once

#include <Eigen/Core>

#include "aras_visual_servo_sim/camera/camera_model.hpp"

namespace aras_visual_servo_sim {

/** Depth of the point at 1 on a ray along the axis that near_m and far_m are measured on. */
inline double aheadOf(const CameraModel& camera, const Eigen::Vector3d& ray) {
  return camera.lens() == CameraModel::Lens::kEquidistant ? ray.cwiseAbs().maxCoeff() : 1.0;
}

/** Rays that see the square of a pixel: middle + x * across + y * down, x and y in [-1/2, 1/2]. Exact without a lens,
 *  through one the bilinear part of that between the rays through its corners. */
struct PixelRays {
  Eigen::Vector3d middle, across, down;

  Eigen::Vector3d at(double x, double y) const { return middle + x * across + y * down; }

  static PixelRays of(const CameraModel& camera, int u, int v) {
    if (camera.lens() == CameraModel::Lens::kNone) {
      return {{(u - camera.cx()) / camera.fx(), (v - camera.cy()) / camera.fy(), 1.0},
              {1.0 / camera.fx(), 0.0, 0.0},
              {0.0, 1.0 / camera.fy(), 0.0}};
    }
    const Eigen::Vector3d* top = camera.cornerRays().data() + std::size_t(v) * (camera.width() + 1) + u;
    const Eigen::Vector3d* bottom = top + camera.width() + 1;
    return {0.25 * (top[0] + top[1] + bottom[0] + bottom[1]), 0.5 * (top[1] + bottom[1] - top[0] - bottom[0]),
            0.5 * (bottom[0] + bottom[1] - top[0] - top[1])};
  }
};

}  // namespace aras_visual_servo_sim
