#include "aras_visual_servo_sim/image/sensor/sensor.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

#include "aras_visual_servo_sim/image/sensor/jpeg.hpp"
#include "image/sensor/effects.hpp"

namespace aras_visual_servo_sim {
namespace {

constexpr std::uint64_t kDarkPattern = 0x6473;  // keeps DSNU apart from PRNU
constexpr double kWhite = 255.0 * kUnitsOf<std::uint16_t>;

/** K of a sensor: without a given one, a full pixel is the largest digital number. */
double systemGain(const SensorConfig& sensor) {
  return sensor.system_gain_dn_per_e.value_or((mostDn(sensor) - sensor.black_level_dn) / sensor.saturation_capacity_e);
}

}  // namespace

Sensor::Sensor(const SensorConfig& config, int width, int height, Encoding encoding, const std::vector<float>& cosines,
               double integration_s, std::uint64_t seed, std::uint64_t pattern_seed, double focal_px)
    : config_(config),
      width_(width),
      height_(height),
      encoding_(encoding),
      dark_e_(config.dark_current_e_per_s * integration_s),
      seed_(seed),
      tones_(toneCurve(config.adc_bits, config.gamma)) {
  const int channels = channelsOf(encoding), count = width * channels;
  const std::size_t size = static_cast<std::size_t>(count) * height;
  for (int row = 0; row < 2; ++row) {
    for (int x = 0; x < count; ++x) colors_[row].push_back(static_cast<std::uint8_t>(colorAt(encoding, x, row)));
  }
  const std::vector<float> prnu = fixedPattern(config.prnu, size, pattern_seed);
  offset_e_ = fixedPattern(config.dsnu_e, size, pattern_seed ^ kDarkPattern);
  const double white_e = config.white_photons * config.quantum_efficiency;
  response_.resize(size);
  for (std::size_t i = 0; i < size; ++i) {
    const int v = static_cast<int>(i) / count, x = static_cast<int>(i) % count;
    double response = white_e / kWhite;
    if (!isMono(encoding)) response *= config.color_response[colors_[v % 2][x]];
    if (!cosines.empty()) response *= std::pow(cosines[i / channels], config.vignetting_exponent);
    if (!prnu.empty()) response *= std::max(0.0, 1.0 + prnu[i]);
    response_[i] = static_cast<float>(response);
  }
  if (config.depth_of_field) depth_blur_.emplace(ThinLens{*config.depth_of_field, focal_px});
  restore({});
}

void Sensor::restore(State state) {
  state_ = std::move(state);
  if (const auto& automatic = config_.auto_exposure; automatic) {
    state_.brightness =
        std::clamp(state_.brightness, automatic->min_exposure, automatic->max_exposure * automatic->max_gain);
  }
}

void Sensor::readOut(FineImage& light, std::uint64_t frame_index, bool fresh, Image& image) {
  if (fresh) takeSettings();
  defocus(config_.defocus_px, light);
  const FineImage* seen = &light;
  if (isBayer(encoding_)) {
    throughBayerFilter(light, encoding_, mosaic_);
    seen = &mosaic_;
  }
  digitise(*seen, frame_index);
  if (fresh) meter();
  isDeep(encoding_) ? develop<std::uint16_t>(image) : develop<std::uint8_t>(image);
  if (config_.jpeg_quality > 0) throughJpeg(config_.jpeg_quality, image);
}

/** The settings that earlier frames have asked for become those of this one. */
void Sensor::takeSettings() {
  const auto take = [](auto& queue, auto& value, int delay_frames) {
    if (static_cast<int>(queue.size()) < delay_frames) return;
    value = queue.front();
    queue.pop_front();
  };
  if (config_.auto_exposure) take(state_.brightnesses, state_.brightness, config_.auto_exposure->delay_frames);
  if (config_.auto_white_balance) take(state_.balances, state_.balance, config_.auto_white_balance->delay_frames);
}

void Sensor::digitise(const FineImage& light, std::uint64_t frame_index) {
  ExposureSetting setting{1.0, 1.0};
  if (config_.auto_exposure) setting = exposureOf(*config_.auto_exposure, state_.brightness);
  const auto exposure = static_cast<float>(setting.exposure), dark_e = static_cast<float>(dark_e_ * setting.exposure);
  const auto gain = static_cast<float>(systemGain(config_) * setting.gain);
  const auto full_e = static_cast<float>(config_.saturation_capacity_e);
  const auto black = static_cast<float>(config_.black_level_dn), most = static_cast<float>(mostDn(config_));
  const auto dark_noise = static_cast<float>(config_.dark_noise_e);
  const std::uint64_t stream = frameStream(seed_, frame_index);
  const float* quantiles = normalQuantiles().data();
  numbers_.resize(light.data.size());
  for (std::size_t i = 0; i < numbers_.size(); ++i) {
    const std::uint64_t word = randomWord(stream, i);
    const float mean = static_cast<float>(light.data[i]) * response_[i] * exposure + dark_e;
    float electrons = config_.shot_noise ? shotNoise(mean, static_cast<std::uint32_t>(word), quantiles) : mean;
    electrons = std::min(electrons, full_e) + dark_noise * quantiles[word >> 48];
    if (!offset_e_.empty()) electrons += offset_e_[i];
    const float number = black + gain * electrons + 0.5f;
    numbers_[i] = static_cast<std::uint16_t>(std::max(0.0f, std::min(most, number)));
  }
}

/** What the camera makes of a frame for those to come. */
void Sensor::meter() {
  if (!setsItself()) return;
  std::array<double, 3> sums{}, counts{};
  const std::size_t stride = colors_[0].size();
  for (int v = 0; v < height_; ++v) {
    const std::uint16_t* row = numbers_.data() + stride * v;
    for (std::size_t x = 0; x < stride; ++x) {
      const int color = colors_[v % 2][x];
      sums[color] += row[x] - config_.black_level_dn;
      counts[color] += 1.0;
    }
  }
  const double range = mostDn(config_) - config_.black_level_dn;
  if (const auto& automatic = config_.auto_exposure; automatic) {
    const double all = counts[0] + counts[1] + counts[2];
    const double level = (sums[0] + sums[1] + sums[2]) / (all * range);
    state_.brightnesses.push_back(nextBrightness(*automatic, state_.brightness, level));
  }
  if (const auto& automatic = config_.auto_white_balance; automatic) {
    std::array<double, 3> means{};
    for (int c = 0; c < 3; ++c) means[c] = counts[c] > 0.0 ? sums[c] / counts[c] : 0.0;
    state_.balances.push_back(nextBalance(*automatic, state_.balance, means));
  }
}

/** White balance and tones. @tparam Value  of the image */
template <typename Value>
void Sensor::develop(Image& image) const {
  image.resize(width_, height_, encoding_);
  std::array<float, 3> gains{1.0f, 1.0f, 1.0f};
  if (!isMono(encoding_)) {
    const std::array<double, 3> automatic{state_.balance[0], 1.0, state_.balance[1]};
    for (int c = 0; c < 3; ++c) gains[c] = static_cast<float>(config_.white_balance[c] * automatic[c]);
  }
  const bool balanced = gains == std::array<float, 3>{1.0f, 1.0f, 1.0f};
  const auto black = static_cast<float>(config_.black_level_dn), most = static_cast<float>(mostDn(config_));
  const std::size_t stride = colors_[0].size();
  for (int v = 0; v < height_; ++v) {
    const std::uint16_t* from = numbers_.data() + stride * v;
    std::uint8_t* to = image.pixel(0, v);
    const auto put = [this, to](std::size_t x, std::size_t number) {
      const auto value = static_cast<Value>(tones_[number] >> (16 - 8 * sizeof(Value)));
      std::memcpy(to + x * sizeof(Value), &value, sizeof(Value));
    };
    for (std::size_t x = 0; x < stride; ++x) {
      if (balanced) {
        put(x, from[x]);
        continue;
      }
      const float number = black + gains[colors_[v % 2][x]] * (static_cast<float>(from[x]) - black) + 0.5f;
      put(x, static_cast<std::size_t>(std::max(0.0f, std::min(most, number))));
    }
  }
}

}  // namespace aras_visual_servo_sim
