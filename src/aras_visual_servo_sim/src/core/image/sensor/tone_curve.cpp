#include "tone_curve.hpp"

#include <cmath>

namespace aras_visual_servo_sim {

std::vector<std::uint16_t> toneCurve(int adc_bits, double gamma) {
  const int count = 1 << adc_bits;
  const double most = count - 1;
  std::vector<std::uint16_t> tones;
  for (int number = 0; number < count; ++number) {
    const double lit = gamma == 1.0 ? number : std::round(most * std::pow(number / most, 1.0 / gamma));
    tones.push_back(static_cast<std::uint16_t>(lit * 65536.0 / count));
  }
  return tones;
}

}  // namespace aras_visual_servo_sim
