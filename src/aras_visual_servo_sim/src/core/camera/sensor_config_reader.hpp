#pragma once

#include "aras_visual_servo_sim/config/section.hpp"
#include "aras_visual_servo_sim/image/sensor/sensor_config.hpp"

namespace aras_visual_servo_sim {

/** Reads the section `sensor`; its faults are the reader's. */
SensorConfig readSensorConfig(YamlReader reader);

/** Adds what a schema cannot express. @param color  the image has red, green and blue */
void checkSensor(const SensorConfig& sensor, bool color, FaultList& faults);

}  // namespace aras_visual_servo_sim
