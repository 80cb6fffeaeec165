#pragma once

#include <aras_visual_servo_common/yaml_reader.hpp>
#include <string>

#include "aras_visual_servo_camera/config/depth_config.hpp"

namespace aras_visual_servo_camera {

/** The section `depth`, open in a reader that is finished by the caller. */
inline DepthConfig readDepth(aras_visual_servo_common::YamlReader reader) {
  DepthConfig config;
  config.window_px = reader.get<int>("window_px");
  config.max_step = reader.get<double>("max_step");
  if (config.window_px % 2 == 0) reader.fault("window_px", std::to_string(config.window_px), "an odd number");
  return config;
}

}  // namespace aras_visual_servo_camera
