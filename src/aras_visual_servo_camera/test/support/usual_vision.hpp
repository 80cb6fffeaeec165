#pragma once

#include <yaml-cpp/yaml.h>

#include "aras_visual_servo_camera/config/vision_config.hpp"

namespace aras_visual_servo_camera::testing {

/** The defaults of the section `vision`, and the two keys that it requires. */
inline VisionConfig usualVision() {
  VisionConfig config = readVisionConfig(YAML::Load("{object: dark, segmentation: coverage}"));
  config.threshold = 128.0;  // for tests that then ask for `fixed`
  return config;
}

/** The defaults of the section `photometric`. */
inline PhotometricConfig usualPhotometric() { return readPhotometricConfig(YAML::Node()); }

}  // namespace aras_visual_servo_camera::testing
