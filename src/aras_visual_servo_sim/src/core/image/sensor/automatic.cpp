#include "automatic.hpp"

#include <algorithm>
#include <cmath>

namespace aras_visual_servo_sim {
namespace {

constexpr double kDarkest = 1e-3;  // what is darker counts for this, so that a covered lens moves no faster

}  // namespace

ExposureSetting exposureOf(const AutoExposureConfig& config, double brightness) {
  const double exposure = std::clamp(brightness, config.min_exposure, config.max_exposure);
  return {exposure, std::clamp(brightness / exposure, 1.0, config.max_gain)};
}

double nextBrightness(const AutoExposureConfig& config, double brightness, double level) {
  const double next = brightness * std::pow(config.level / std::max(level, kDarkest), config.speed);
  return std::clamp(next, config.min_exposure, config.max_exposure * config.max_gain);
}

std::array<double, 2> nextBalance(const AutoWhiteBalanceConfig& config, const std::array<double, 2>& gains,
                                  const std::array<double, 3>& means) {
  const auto next = [&](double gain, double mean) {
    if (!(mean > 0.0 && means[1] > 0.0)) return gain;
    const double moved = gain * std::pow(means[1] / (mean * gain), config.speed);
    return std::clamp(moved, 1.0 / config.max_gain, config.max_gain);
  };
  return {next(gains[0], means[0]), next(gains[1], means[2])};
}

}  // namespace aras_visual_servo_sim
