#pragma once

#include <optional>
#include <string>
#include <vector>

#include "aras_visual_servo_sim/config/types.hpp"
#include "aras_visual_servo_sim/image/sensor/sensor_config.hpp"

namespace aras_visual_servo_sim {

/** Intrinsics told by camera_info where the image is drawn with others: a plumb_bob camera with f = fx = fy [px]. */
struct ToldIntrinsics {
  double f_px = 0.0, cx_px = 0.0, cy_px = 0.0;
  std::vector<double> distortion;  ///< k1 k2 p1 p2 k3
};

/** A camera as a scenario or a URDF describes it; schema/camera.yaml says what each key means and what it may be. */
struct CameraConfig {
  /** With the section's defaults; what the section requires is empty or zero. */
  CameraConfig();

  std::string name, frame;
  std::string mount;  ///< if not empty: the link that carries C, at X_MC; `frame` is then only the name of C
  Pose X_MC;
  int width = 0, height = 0;
  std::optional<double> horizontal_fov_rad, fx_px, fy_px, cx_px, cy_px;
  std::string distortion_model;
  std::vector<double> distortion;
  std::optional<double> cutoff_angle_rad;
  double rate_hz = 0.0;
  std::string encoding;
  double near_m = 0.0, far_m = 0.0;  ///< depth Z; of a fisheye max(|X|, |Y|, |Z|)
  std::string sampling;
  std::string renderer, quality, gl;
  bool exact_targets = false;
  double noise_mean = 0.0, noise_stddev = 0.0;
  double exposure_s = 0.0;
  int exposure_samples = 0;
  std::optional<SensorConfig> sensor;  ///< nothing: an image is what the scene shows
  double latency_s = 0.0;
  double drop_probability = 0.0;
  bool triggered = false;
  double baseline_m = 0.0;
  std::optional<ToldIntrinsics> told;  ///< for `compatibility: gazebo`; nothing: camera_info is that of the drawing
};

}  // namespace aras_visual_servo_sim
