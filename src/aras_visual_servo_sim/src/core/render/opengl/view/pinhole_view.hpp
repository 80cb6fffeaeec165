#pragma once

#include <Eigen/Core>

#include "aras_visual_servo_sim/camera/camera_model.hpp"
#include "render/view/pixel_box.hpp"

namespace aras_visual_servo_sim {

/** A picture that a pinhole at the camera's origin makes. Pixels are counted as CameraModel does. */
struct PinholeView {
  Eigen::Matrix3d R_FC = Eigen::Matrix3d::Identity();  ///< of the pinhole's frame F: x right, y down, z forward
  double fx = 0.0, fy = 0.0, cx = 0.0, cy = 0.0;       ///< [px]
  int width = 0, height = 0;

  /** Clip coordinates of points in C: depth near / Z, 1 at the near plane and 0 at infinity, so that 32 bits of float
   *  are as fine far away as near by; OpenGL's rows grow downwards, as the image's do. */
  Eigen::Matrix4f projection(double near_m) const {
    Eigen::Matrix4d P = Eigen::Matrix4d::Zero();
    P(0, 0) = 2.0 * fx / width;
    P(0, 2) = (2.0 * cx + 1.0) / width - 1.0;
    P(1, 1) = 2.0 * fy / height;
    P(1, 2) = (2.0 * cy + 1.0) / height - 1.0;
    P(2, 3) = near_m;
    P(3, 2) = 1.0;
    P.leftCols<3>() = (P.leftCols<3>() * R_FC).eval();
    return P.cast<float>();
  }

  /** Slopes X / Z and Y / Z, in F, of lines around the picture. */
  struct Border {
    double left, right, top, bottom;
  };
  /** @param rim  how far outside the centres of the outermost pixels [px] */
  Border border(double rim) const {
    return {(-rim - cx) / fx, (width - 1.0 + rim - cx) / fx, (-rim - cy) / fy, (height - 1.0 + rim - cy) / fy};
  }
  /** Ray, in F, through a corner of a box, or outside it by a rim [px]. @param k  bits 0, 1 choose right and bottom */
  Eigen::Vector3d rayThroughCorner(const PixelBox& box, int k, double rim = 0.0) const {
    return {((k & 1 ? box.u1 + rim : box.u0 - rim) - 0.5 - cx) / fx,
            ((k & 2 ? box.v1 + rim : box.v0 - rim) - 0.5 - cy) / fy, 1.0};
  }

  /** What a camera without a lens sees, in pixels of 1 / factor. */
  static PinholeView of(const CameraModel& camera, int factor = 1) {
    PinholeView view;
    view.width = factor * camera.width();
    view.height = factor * camera.height();
    view.fx = factor * camera.fx();
    view.fy = factor * camera.fy();
    view.cx = factor * (camera.cx() + 0.5) - 0.5;
    view.cy = factor * (camera.cy() + 0.5) - 0.5;
    return view;
  }
};

}  // namespace aras_visual_servo_sim
