#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <map>
#include <string>

#include "aras_visual_servo_sim/config/types.hpp"
#include "aras_visual_servo_sim/image/image.hpp"

namespace aras_visual_servo_sim {

/** What was true when an image was exposed. */
struct FrameState {
  std::int64_t stamp_ns = 0;           ///< simulated time of the exposure
  Eigen::VectorXd q, v;                ///< of the joints, sorted by name [m or rad, per s]
  Pose X_WC;                           ///< of the camera
  Twist V_WC_C = Twist::Zero();        ///< of the camera
  std::map<std::string, Pose> models;  ///< X_WM by name
};

/** An image and what was true when it was exposed. */
struct Frame {
  const Image* image;  ///< the camera's own: its content lasts until the next render of this camera
  FrameState state;
};

}  // namespace aras_visual_servo_sim
