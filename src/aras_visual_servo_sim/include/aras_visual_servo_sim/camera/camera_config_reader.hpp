#pragma once

#include <yaml-cpp/yaml.h>

#include "aras_visual_servo_sim/camera/camera_config.hpp"
#include "aras_visual_servo_sim/config/yaml_reader.hpp"

namespace aras_visual_servo_sim {

/** Reads one entry of `cameras:`; keys are the members of CameraConfig. @throws ParameterError listing all faults */
CameraConfig cameraConfigFromYaml(const YAML::Node& node);
/** The same as part of a larger reading: faults go to reader, whose owner calls finish(). */
CameraConfig readCameraConfig(YamlReader& reader);

}  // namespace aras_visual_servo_sim
