#include "fixed_pattern.hpp"

#include "normal_draws.hpp"

namespace aras_visual_servo_sim {

std::vector<float> fixedPattern(double stddev, std::size_t count, std::uint64_t seed) {
  if (stddev == 0.0) return {};
  const std::uint64_t stream = frameStream(seed, 0);
  std::vector<float> pattern(count);
  for (std::size_t i = 0; i < count; ++i) {
    pattern[i] = static_cast<float>(stddev) * normalQuantiles()[randomWord(stream, i) >> 48];
  }
  return pattern;
}

}  // namespace aras_visual_servo_sim
