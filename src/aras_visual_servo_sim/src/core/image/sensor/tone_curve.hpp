#pragma once

#include <cstdint>
#include <vector>

namespace aras_visual_servo_sim {

/** Each digital number after gamma, in the upper adc_bits of 16; the rest is 0. @return 2^adc_bits values */
std::vector<std::uint16_t> toneCurve(int adc_bits, double gamma);

}  // namespace aras_visual_servo_sim
