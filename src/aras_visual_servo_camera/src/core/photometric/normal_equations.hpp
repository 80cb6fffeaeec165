#pragma once

#include <array>
#include <opencv2/core.hpp>

namespace aras_visual_servo_camera {

using Vector6 = std::array<double, 6>;

/** H = L^T L and b = L^T e of one image, after the changes that the illumination explains have been removed. */
struct NormalEquations {
  cv::Matx66d H;
  Vector6 b{};
  double cost = 0.0;  ///< e^T e / 2, grey levels squared
};

/** Solution of H step = -b. */
struct GaussNewton {
  bool solvable = false;   ///< six motions are told apart
  double condition = 0.0;  ///< of L, its columns scaled to length 1; infinite if it is singular
  Vector6 step{};          ///< -H^-1 b [m, rad]
};

/** @param smallest  a column of L shorter than this, per pixel, tells nothing [grey levels per m, rad] */
GaussNewton solve(const NormalEquations& equations, int pixels, double smallest);

}  // namespace aras_visual_servo_camera
