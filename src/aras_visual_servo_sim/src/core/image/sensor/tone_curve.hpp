#pragma once

#include <cstdint>
#include <vector>

namespace aras_visual_servo_sim {

/** The byte of each digital number: its upper 8 bits after gamma. @return 2^adc_bits bytes */
std::vector<std::uint8_t> toneCurve(int adc_bits, double gamma);

}  // namespace aras_visual_servo_sim
