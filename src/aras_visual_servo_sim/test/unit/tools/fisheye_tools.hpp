#pragma once

#include "render_tools.hpp"

namespace aras_visual_servo_sim::testing {

constexpr double kDegree = M_PI / 180.0;
/** Grows up to 136 degrees, bends r by 8 % at 100 degrees. */
inline std::vector<double> fisheyeCoefficients() { return {-0.03, 0.004, -0.0005, 0.00002}; }

/** 200 degrees across the image's width and height, black beyond. */
inline CameraConfig fisheye200Config(int size = 400) {
  CameraConfig config;
  config.width = config.height = size;
  config.horizontal_fov_rad = 200.0 * kDegree;
  config.cutoff_angle_rad = 100.0 * kDegree;
  config.encoding = "mono8";
  config.distortion_model = "equidistant";
  config.distortion = fisheyeCoefficients();
  return config;
}

/** Kannala and Brandt's formula written out anew: nothing of the simulator but its parameters. */
inline Eigen::Vector2d projectFisheye(const CameraConfig& config, const Eigen::Vector3d& p_C) {
  const std::vector<double>& k = config.distortion;
  const double theta = std::acos(p_C.z() / p_C.norm()), azimuth = std::atan2(p_C.y(), p_C.x());
  double r = theta;
  for (int i = 0; i < 4; ++i) r += k[i] * std::pow(theta, 3 + 2 * i);
  const double f = config.width / *config.horizontal_fov_rad;
  return {0.5 * (config.width - 1) + f * r * std::cos(azimuth), 0.5 * (config.height - 1) + f * r * std::sin(azimuth)};
}

/** A camera at p_W whose axis points along `ahead_W`, its x axis as far along `right_W` as that allows. */
inline Pose lookingAlong(const Eigen::Vector3d& p_W, const Eigen::Vector3d& ahead_W, const Eigen::Vector3d& right_W) {
  Eigen::Matrix3d R;
  R.col(2) = ahead_W.normalized();
  R.col(1) = R.col(2).cross(right_W).normalized();
  R.col(0) = R.col(1).cross(R.col(2));
  return {p_W, Eigen::Quaterniond(R)};
}

}  // namespace aras_visual_servo_sim::testing
