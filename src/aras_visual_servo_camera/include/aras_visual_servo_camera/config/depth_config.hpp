#pragma once

namespace aras_visual_servo_camera {

/** The section `depth` of `vision` and of `vision.matches`. What each key means, its range and its default stand in
 *  schema/depth.yaml, by the names of these members. */
struct DepthConfig {
  int window_px{};
  double max_step{};
};

}  // namespace aras_visual_servo_camera
