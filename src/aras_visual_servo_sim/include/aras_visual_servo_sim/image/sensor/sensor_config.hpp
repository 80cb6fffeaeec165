#pragma once

#include "aras_visual_servo_sim/config/sections.hpp"

namespace aras_visual_servo_sim {

/** The largest digital number of a sensor. */
inline double mostDn(const SensorConfig& sensor) { return static_cast<double>((1 << sensor.adc_bits) - 1); }

/** K of a sensor: without a given one, a full pixel is the largest digital number. */
inline double systemGain(const SensorConfig& sensor) {
  return sensor.system_gain_dn_per_e.value_or((mostDn(sensor) - sensor.black_level_dn) / sensor.saturation_capacity_e);
}

}  // namespace aras_visual_servo_sim
