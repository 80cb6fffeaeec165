#pragma once

#include <optional>
#include <string>
#include <vector>

#include "aras_visual_servo_sim/config/sections.hpp"
#include "aras_visual_servo_sim/config/types.hpp"

namespace aras_visual_servo_sim {

/** Intrinsics told by camera_info where the image is drawn with others: a plumb_bob camera with f = fx = fy [px]. */
struct ToldIntrinsics {
  double f_px = 0.0, cx_px = 0.0, cy_px = 0.0;
  std::vector<double> distortion;  ///< k1 k2 p1 p2 k3
};

/** A camera as a scenario or a URDF describes it. */
struct CameraConfig : CameraKeys {
  std::string mount;  ///< if not empty: the link that carries C, at X_MC; `frame` is then only the name of C
  Pose X_MC;
  std::optional<ToldIntrinsics> told;  ///< for `compatibility: gazebo`; nothing: camera_info is that of the drawing
};

}  // namespace aras_visual_servo_sim
