#include "effects.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "aras_visual_servo_sim/config/wide.hpp"

namespace aras_visual_servo_sim {

namespace {

constexpr double kDarkest = 1e-3;  // what is darker counts for this, so that a covered lens moves no faster
constexpr int kQuantiles = 1 << 16;

ARAS_WIDE void addRow(const float* from, float share, int count, float* to) {
  for (int i = 0; i < count; ++i) to[i] += share * from[i];
}

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

const std::vector<float>& normalQuantiles() {
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

int reachOfDisc(double diameter_px) { return std::max(0, static_cast<int>(std::ceil(0.5 * diameter_px - 0.5))); }

std::vector<float> discOf(double diameter_px) {
  constexpr int kFine = 32;  // samples along a side of a pixel
  const int reach = reachOfDisc(diameter_px), side = 2 * reach + 1;
  std::vector<float> disc(static_cast<std::size_t>(side) * side);
  const double square = 0.25 * diameter_px * diameter_px;
  double sum = 0.0;
  for (int j = 0; j < side; ++j) {
    for (int i = 0; i < side; ++i) {
      int inside = 0;
      for (int k = 0; k < kFine * kFine; ++k) {
        const double x = i - reach - 0.5 + (k % kFine + 0.5) / kFine, y = j - reach - 0.5 + (k / kFine + 0.5) / kFine;
        if (x * x + y * y <= square) ++inside;
      }
      disc[static_cast<std::size_t>(j) * side + i] = static_cast<float>(inside);
      sum += inside;
    }
  }
  for (float& share : disc) share /= static_cast<float>(sum);
  return disc;
}

void defocus(double diameter_px, FineImage& image) {
  const int reach = reachOfDisc(diameter_px);
  if (reach == 0) return;  // the disc stays in its pixel
  const std::vector<float> disc = discOf(diameter_px);
  const int channels = image.channels(), side = 2 * reach + 1, count = image.width * channels;
  const std::size_t stride = static_cast<std::size_t>(image.width + 2 * reach) * channels;
  std::vector<float> padded(stride * (image.height + 2 * reach)), row(count);
  for (int v = 0; v < image.height + 2 * reach; ++v) {
    const std::uint16_t* from = image.pixel(0, std::clamp(v - reach, 0, image.height - 1));
    float* to = padded.data() + stride * v;
    for (int u = -reach; u < image.width + reach; ++u) {
      const std::uint16_t* pixel = from + std::clamp(u, 0, image.width - 1) * channels;
      for (int c = 0; c < channels; ++c) *to++ = pixel[c];
    }
  }
  for (int v = 0; v < image.height; ++v) {
    std::fill(row.begin(), row.end(), 0.5f);
    for (int j = 0; j < side; ++j) {
      for (int i = 0; i < side; ++i) {
        const float share = disc[static_cast<std::size_t>(j) * side + i];
        if (share > 0.0f)
          addRow(padded.data() + stride * (v + j) + std::size_t(i) * channels, share, count, row.data());
      }
    }
    std::uint16_t* to = image.pixel(0, v);
    for (int i = 0; i < count; ++i) to[i] = static_cast<std::uint16_t>(std::min(row[i], 65535.0f));
  }
}

}  // namespace aras_visual_servo_sim
