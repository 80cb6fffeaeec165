#include "aras_visual_servo_sim/image/sensor/gaussian_noise.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "aras_visual_servo_sim/config/wide.hpp"
#include "effects.hpp"

namespace aras_visual_servo_sim {
namespace {

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

/** The same, rounded to the unit of light and written as two bytes. */
ARAS_WIDE void addDrawnDeep(const std::uint16_t* light, const float* drawn, int count, float scale, float offset,
                            std::uint8_t* bytes) {
  constexpr float kUnits = kUnitsOf<std::uint16_t>;
  for (int i = 0; i < count; ++i) {
    const float value = static_cast<float>(light[i]) + kUnits * (offset + scale * drawn[i]);
    const float held = std::max(0.0f, std::min(65535.0f, value + 0.5f));
    const auto whole = static_cast<std::uint16_t>(static_cast<std::int32_t>(held));
    std::memcpy(bytes + 2 * i, &whole, sizeof(whole));
  }
}

}  // namespace

void addGaussianNoise(const FineImage& light, double stddev, std::uint64_t seed, std::uint64_t frame_index, double mean,
                      Encoding encoding, Image& image) {
  if (!std::isfinite(stddev) || stddev < 0.0) {
    throw ParameterError("noise_stddev: found " + std::to_string(stddev) + ", allowed finite and >= 0");
  }
  if (!std::isfinite(mean)) throw ParameterError("noise_mean: found " + std::to_string(mean) + ", allowed finite");
  image.resize(light.width, light.height, encoding);
  const bool deep = isDeep(encoding);
  const std::uint64_t stream = frameStream(seed, frame_index);
  const std::vector<float>& quantiles = normalQuantiles();
  const float scale = static_cast<float>(stddev), offset = static_cast<float>(mean);
  constexpr std::size_t kBlock = 256;
  std::array<float, kBlock> drawn;
  for (std::size_t first = 0; first < light.data.size(); first += kBlock) {
    for (std::size_t i = 0; i < kBlock; i += 4) {  // four 16-bit draws from one word
      const std::uint64_t bits = randomWord(stream, (first + i) / 4);
      for (std::size_t k = 0; k < 4; ++k) drawn[i + k] = quantiles[(bits >> (16 * k)) & 0xffff];
    }
    const std::size_t count = std::min(kBlock, light.data.size() - first);
    const auto add = deep ? addDrawnDeep : addDrawn;
    add(light.data.data() + first, drawn.data(), static_cast<int>(count), scale, offset,
        image.data.data() + first * (deep ? 2 : 1));
  }
}

}  // namespace aras_visual_servo_sim
