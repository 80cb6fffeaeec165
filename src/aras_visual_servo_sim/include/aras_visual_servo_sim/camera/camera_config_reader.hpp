#pragma once

#include <yaml-cpp/yaml.h>

#include "aras_visual_servo_sim/camera/camera_config.hpp"
#include "aras_visual_servo_sim/config/section.hpp"

namespace aras_visual_servo_sim {

/** Reads a camera, section `camera`. @throws ParameterError listing all faults, also those that CameraModel finds */
CameraConfig cameraConfigFromYaml(const YAML::Node& node);
/** The same, as a part of a larger document: faults are added to reader, whose owner calls finish(). */
CameraConfig readCameraConfig(YamlReader& reader);
/** Checks each key against the section; names may be empty. */
void checkKeys(const CameraConfig& camera, FaultList& faults);

}  // namespace aras_visual_servo_sim
