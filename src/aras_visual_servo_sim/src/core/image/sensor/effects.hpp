#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "aras_visual_servo_sim/config/sections.hpp"
#include "aras_visual_servo_sim/config/splitmix.hpp"
#include "aras_visual_servo_sim/image/image.hpp"

namespace aras_visual_servo_sim {

/** What an exposure is made with: how long, as a share of the one that white_photons is for, and a factor of K. */
struct ExposureSetting {
  double exposure, gain;
};

/** Splits a factor of the brightness: the exposure first, the gain where the exposure is the longest. */
ExposureSetting exposureOf(const AutoExposureConfig& config, double brightness);

/** The brightness, within the limits, for the image that comes delay_frames after one that was made with `brightness`.
 *  @param level  mean of that image over its largest */
double nextBrightness(const AutoExposureConfig& config, double brightness, double level);

/** The gains of red and blue for the image that comes delay_frames after one with these, of a world grey in the mean.
 *  @param means  of red, green and blue, before gains */
std::array<double, 2> nextBalance(const AutoWhiteBalanceConfig& config, const std::array<double, 2>& gains,
                                  const std::array<double, 3>& means);

/** Quantiles of the standard normal distribution at (k + 1/2) / 2^16: made once. */
const std::vector<float>& normalQuantiles();

/** Where the random words of a frame begin: word k of it is mix(stream + (k + 1) kGolden). */
inline std::uint64_t frameStream(std::uint64_t seed, std::uint64_t frame_index) {
  return splitmix::mix(splitmix::mix(seed + splitmix::kGolden) ^ (frame_index * splitmix::kGolden + 1));
}

inline std::uint64_t randomWord(std::uint64_t stream, std::uint64_t index) {
  return splitmix::mix(stream + (index + 1) * splitmix::kGolden);
}

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

/** Normal numbers of mean 0 and this deviation that belong to the pixels of a sensor, the same in every frame.
 *  @param seed  of the pattern  @return empty if the deviation is 0 */
std::vector<float> fixedPattern(double stddev, std::size_t count, std::uint64_t seed);

/** Each digital number after gamma, in the upper adc_bits of 16; the rest is 0. @return 2^adc_bits values */
std::vector<std::uint16_t> toneCurve(int adc_bits, double gamma);

/** How many pixels a disc about the middle of a pixel reaches beyond it. */
int reachOfDisc(double diameter_px);
/** What of a disc lies in each pixel about its middle: (2 reach + 1)^2 shares, row by row, that sum up to 1. */
std::vector<float> discOf(double diameter_px);

/** Spreads every point of an image evenly over a disc: a pixel becomes the mean over the disc about its middle, the
 *  squares of the pixels being of one value. Beyond its border the image goes on as at the border.
 *  @param diameter_px  >= 0 */
void defocus(double diameter_px, FineImage& image);

}  // namespace aras_visual_servo_sim
