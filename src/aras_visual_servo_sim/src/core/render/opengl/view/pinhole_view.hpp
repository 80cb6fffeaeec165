#pragma once

#include <Eigen/Core>

#include "aras_visual_servo_sim/camera/camera_model.hpp"

namespace aras_visual_servo_sim {

/** A picture that a pinhole at the camera's origin makes: what OpenGL can draw. Pixels are counted as CameraModel does.
 */
struct PinholeView {
  Eigen::Matrix3d R_FC = Eigen::Matrix3d::Identity();  ///< of the pinhole's frame F: x right, y down, z forward
  double fx = 0.0, fy = 0.0, cx = 0.0, cy = 0.0;       ///< [px]
  int width = 0, height = 0;

  /** Clip coordinates of points in C: depth near / Z, 1 at the near plane and 0 at infinity, so that 32 bits of float
   *  are as fine far away as near by; OpenGL's rows grow downwards, as the image's do. */
  Eigen::Matrix4f projection(double near_m) const;
  /** The same picture in pixels of 1 / factor. */
  PinholeView scaled(int factor) const;

  /** What a camera without a lens sees. */
  static PinholeView of(const CameraModel& camera);
};

}  // namespace aras_visual_servo_sim
