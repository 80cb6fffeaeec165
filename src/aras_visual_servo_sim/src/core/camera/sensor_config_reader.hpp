#pragma once

#include <string>

#include "aras_visual_servo_sim/config/section.hpp"
#include "aras_visual_servo_sim/image/sensor/sensor_config.hpp"

namespace aras_visual_servo_sim {

/** Reads the section `sensor`; its faults are the reader's. */
SensorConfig readSensorConfig(YamlReader reader);

/** Adds what a schema cannot express. @param encoding  of the image */
void checkSensor(const SensorConfig& sensor, const std::string& encoding, FaultList& faults);

}  // namespace aras_visual_servo_sim
