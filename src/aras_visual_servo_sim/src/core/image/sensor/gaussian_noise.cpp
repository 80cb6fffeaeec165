#include "aras_visual_servo_sim/image/sensor/gaussian_noise.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "aras_visual_servo_sim/config/splitmix.hpp"
#include "aras_visual_servo_sim/config/wide.hpp"

namespace aras_visual_servo_sim {
namespace {

constexpr int kQuantiles = 1 << 16;

/** Quantiles of the standard normal distribution at (k + 1/2) / 2^16, by bisection of erfc: made once. */
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

/** light[i] in grey levels + offset + scale * drawn[i], rounded to a byte. */
ARAS_WIDE void addDrawn(const std::uint16_t* light, const float* drawn, int count, float scale, float offset,
                        std::uint8_t* values) {
  constexpr float kLevels = 1.0f / kUnitsOf<std::uint16_t>;
  for (int i = 0; i < count; ++i) {
    const float value = kLevels * static_cast<float>(light[i]) + offset + scale * drawn[i];
    const float held = std::max(0.0f, std::min(255.0f, value + 0.5f));
    values[i] = static_cast<std::uint8_t>(static_cast<std::int32_t>(held));
  }
}

}  // namespace

void addGaussianNoise(const FineImage& light, double stddev, std::uint64_t seed, std::uint64_t frame_index, double mean,
                      Image& image) {
  if (!std::isfinite(stddev) || stddev < 0.0) {
    throw ParameterError("noise_stddev: found " + std::to_string(stddev) + ", allowed finite and >= 0");
  }
  if (!std::isfinite(mean)) throw ParameterError("noise_mean: found " + std::to_string(mean) + ", allowed finite");
  image.resize(light.width, light.height, light.encoding);
  using splitmix::kGolden;
  using splitmix::mix;
  const std::uint64_t stream = mix(mix(seed + kGolden) ^ (frame_index * kGolden + 1));
  const std::vector<float>& quantiles = normalQuantiles();
  const float scale = static_cast<float>(stddev), offset = static_cast<float>(mean);
  constexpr std::size_t kBlock = 256;
  std::array<float, kBlock> drawn;
  for (std::size_t first = 0; first < image.data.size(); first += kBlock) {
    for (std::size_t i = 0; i < kBlock; i += 4) {  // four 16-bit draws from one word
      const std::uint64_t bits = mix(stream + ((first + i) / 4 + 1) * kGolden);
      for (std::size_t k = 0; k < 4; ++k) drawn[i + k] = quantiles[(bits >> (16 * k)) & 0xffff];
    }
    const std::size_t count = std::min(kBlock, image.data.size() - first);
    addDrawn(light.data.data() + first, drawn.data(), static_cast<int>(count), scale, offset,
             image.data.data() + first);
  }
}

}  // namespace aras_visual_servo_sim
