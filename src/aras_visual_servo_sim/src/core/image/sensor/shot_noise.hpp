#pragma once

#include <cmath>
#include <cstdint>

namespace aras_visual_servo_sim {

/** Number of events of a Poisson process of this mean, from 32 random bits and normalQuantiles().
 *
 *  Below kExact the distribution's own quantile; above, its expansion about the normal one (Cornish and Fisher, 1938)
 *  to the skewness, scaled so that mean and variance are exact. */
inline float shotNoise(float mean, std::uint32_t bits, const float* quantiles) {
  constexpr float kExact = 30.0f;
  if (!(mean > 0.0f)) return 0.0f;
  if (mean >= kExact) {
    const float z = quantiles[bits >> 16];
    return mean + std::sqrt(mean - 1.0f / 18.0f) * z + (z * z - 1.0f) / 6.0f;
  }
  constexpr int kMost = 200;  // beyond it lies less than 1e-80
  const double uniform = (bits + 0.5) * 0x1p-32;
  double probability = std::exp(-double(mean)), sum = probability;
  int count = 0;
  while (uniform > sum && count < kMost) {
    probability *= mean / ++count;
    sum += probability;
  }
  return static_cast<float>(count);
}

}  // namespace aras_visual_servo_sim
