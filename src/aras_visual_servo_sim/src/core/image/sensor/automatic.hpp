#pragma once

#include <array>

#include "aras_visual_servo_sim/image/sensor/sensor_config.hpp"

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

/** The gains of red and blue for the image that comes delay_frames after one with these: so that the means become the
 *  same, by the hypothesis that the world is grey in the mean.
 *  @param means  of red, green and blue, before gains */
std::array<double, 2> nextBalance(const AutoWhiteBalanceConfig& config, const std::array<double, 2>& gains,
                                  const std::array<double, 3>& means);

}  // namespace aras_visual_servo_sim
