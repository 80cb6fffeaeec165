#pragma once

#include <optional>
#include <string>
#include <vector>

#include "aras_visual_servo_sim/config/types.hpp"

namespace aras_visual_servo_sim {

/** What camera_info says where that is not how the image is drawn: a plumb_bob camera with f = fx = fy [px]. */
struct ToldIntrinsics {
  double f_px = 0.0, cx_px = 0.0, cy_px = 0.0;
  std::vector<double> distortion;  ///< k1 k2 p1 p2 k3
};

/** A camera as a scenario or a URDF describes it; CameraModel checks it. Units are in the names; px = pixel. */
struct CameraConfig {
  std::string name = "camera";
  std::string frame;  ///< link that carries the optical frame C: x right, y down, z forward
  std::string mount;  ///< if not empty: the link that carries C instead, at X_MC, and `frame` is but a name for C
  Pose X_MC;
  int width = 0;   ///< [px], 1 .. 16384
  int height = 0;  ///< [px], 1 .. 16384
  /** Either the horizontal field of view, in (0, pi), or fx_px and fy_px, > 0. The field is that of the lens without
   *  distortion: fx = fy = (width / 2) / tan(field / 2), for the equidistant lens, whose field may reach 2 pi,
   *  (width / 2) / (field / 2). */
  std::optional<double> horizontal_fov_rad;
  std::optional<double> fx_px;
  std::optional<double> fy_px;
  std::optional<double> cx_px;  ///< principal point; default (width - 1) / 2
  std::optional<double> cy_px;  ///< principal point; default (height - 1) / 2
  /** "none"; "plumb_bob" (k1 k2 p1 p2 k3); "rational_polynomial" (k1 k2 p1 p2 k3 k4 k5 k6); "equidistant"
   *  (k1 k2 k3 k4). Coefficients as in sensor_msgs/CameraInfo; empty = all zero. */
  std::string distortion_model = "none";
  std::vector<double> distortion;
  /** Equidistant lens only: no ray farther from the axis is drawn, the image is black there; in (0, 2.18]. Default:
   *  none, and black beyond 2.18. SDF's <cutoff_angle>. */
  std::optional<double> cutoff_angle_rad;
  double rate_hz = 30.0;              ///< > 0
  std::string encoding = "rgb8";      ///< "rgb8", "bgr8" or "mono8"
  double near_m = 0.02;               ///< > 0; nothing nearer is seen: Z, through a fisheye max(|X|, |Y|, |Z|)
  double far_m = 5.0;                 ///< > near_m; solids farther away are not drawn
  std::string sampling = "coverage";  ///< "coverage": pixel = mean over its square; "center": value at its centre
  double noise_mean = 0.0;            ///< [grey levels]
  double noise_stddev = 0.0;          ///< [grey levels], >= 0
  double exposure_s = 0.0;   ///< an image is the mean over this long before its stamp; 0 <= exposure_s < 1 / rate_hz
  int exposure_samples = 8;  ///< moments of the exposure that are drawn, 1 .. 256
  double latency_s = 0.0;    ///< an image is delivered this long after its stamp, 0 .. 10
  double drop_probability = 0.0;  ///< of each frame, 0 .. 0.99: it is never taken; seeded by its index
  bool triggered = false;         ///< frames are taken only when asked for, at the next instant of rate_hz
  double baseline_m = 0.0;        ///< right of a stereo pair: distance to the left camera; P(0, 3) = -fx baseline_m
  std::optional<ToldIntrinsics> told;  ///< for `compatibility: gazebo`; nothing: camera_info says how it is drawn
};

}  // namespace aras_visual_servo_sim
