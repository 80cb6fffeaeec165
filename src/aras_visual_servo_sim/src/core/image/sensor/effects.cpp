#include "effects.hpp"

#include <algorithm>

namespace aras_visual_servo_sim {

const std::vector<float>& normalQuantiles() {
  static constexpr int kQuantiles = 1 << 16;
  static const std::vector<float> table = [] {
    std::vector<float> quantiles(kQuantiles);
    double z = -5.0;
    for (int k = 0; k < kQuantiles / 2; ++k) {
      const double p = (k + 0.5) / kQuantiles;
      for (int i = 0; i < 20; ++i) {  // Newton from the previous quantile, below the root of a convex function
        const double density = std::exp(-0.5 * z * z) / std::sqrt(2.0 * M_PI);
        const double step = (p - 0.5 * std::erfc(-z / std::sqrt(2.0))) / density;
        z += std::clamp(step, -0.25, 0.25);
        if (std::abs(step) < 1e-12) break;
      }
      quantiles[k] = static_cast<float>(z);
      quantiles[kQuantiles - 1 - k] = static_cast<float>(-z);
    }
    return quantiles;
  }();
  return table;
}

std::vector<float> fixedPattern(double stddev, std::size_t count, std::uint64_t seed) {
  if (stddev == 0.0) return {};
  const std::uint64_t stream = frameStream(seed, 0);
  std::vector<float> pattern(count);
  for (std::size_t i = 0; i < count; ++i) {
    pattern[i] = static_cast<float>(stddev) * normalQuantiles()[randomWord(stream, i) >> 48];
  }
  return pattern;
}

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

ExposureSetting exposureOf(const AutoExposureConfig& config, double brightness) {
  const double exposure = std::clamp(brightness, config.min_exposure, config.max_exposure);
  return {exposure, std::clamp(brightness / exposure, 1.0, config.max_gain)};
}

double nextBrightness(const AutoExposureConfig& config, double brightness, double level) {
  constexpr double kDarkest = 1e-3;  // what is darker counts for this, so that a covered lens moves no faster
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
