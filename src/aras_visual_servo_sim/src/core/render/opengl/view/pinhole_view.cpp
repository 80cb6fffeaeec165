#include "pinhole_view.hpp"

namespace aras_visual_servo_sim {

Eigen::Matrix4f PinholeView::projection(double near_m) const {
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

PinholeView PinholeView::scaled(int factor) const {
  PinholeView view = *this;
  view.width *= factor;
  view.height *= factor;
  view.fx *= factor;
  view.fy *= factor;
  view.cx = factor * (cx + 0.5) - 0.5;
  view.cy = factor * (cy + 0.5) - 0.5;
  return view;
}

PinholeView PinholeView::of(const CameraModel& camera) {
  PinholeView view;
  view.fx = camera.fx();
  view.fy = camera.fy();
  view.cx = camera.cx();
  view.cy = camera.cy();
  view.width = camera.width();
  view.height = camera.height();
  return view;
}

}  // namespace aras_visual_servo_sim
