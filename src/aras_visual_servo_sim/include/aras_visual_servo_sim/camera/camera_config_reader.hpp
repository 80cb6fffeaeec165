#pragma once

#include "aras_visual_servo_sim/camera/camera_config.hpp"
#include "aras_visual_servo_sim/config/section.hpp"

namespace aras_visual_servo_sim {

/** Reads a camera, section `camera`. @throws ParameterError listing all faults, also those that CameraModel finds */
CameraConfig cameraConfigFromYaml(const YAML::Node& node);
/** Checks each key against the section; names may be empty. */
void checkKeys(const CameraConfig& camera, FaultList& faults);
/** Adds what the schema of a camera's sensor cannot express. */
void checkSensor(const SensorConfig& sensor, const std::string& encoding, FaultList& faults);

}  // namespace aras_visual_servo_sim
