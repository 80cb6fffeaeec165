#include "aras_visual_servo_sim/exposure.hpp"

#include <algorithm>
#include <cmath>

namespace aras_visual_servo_sim {

Exposure::Exposure(double exposure_s, int samples, std::int64_t period_ns) {
  const std::int64_t exposure_ns = std::llround(1e9 * exposure_s);
  if (exposure_ns <= 0) return;
  const std::int64_t unit = 2 * samples * period_ns;  // age = (2 j + 1) exposure_ns / unit
  for (std::int64_t j = samples - 1; j >= 0; --j) {
    ages_.push_back(((2 * j + 1) * exposure_ns + unit / 2 - 1) / unit);  // nearest, halves down
  }
}

bool Exposure::samples(std::int64_t tick, std::int64_t frame_tick) const {
  return std::find(ages_.begin(), ages_.end(), frame_tick - tick) != ages_.end();
}

std::int64_t Exposure::nextSample(std::int64_t tick, std::int64_t frame_tick) const {
  for (const std::int64_t age : ages_) {
    if (frame_tick - age > tick) return frame_tick - age;
  }
  return frame_tick;
}

void Exposure::note(Moment moment, std::int64_t frame_tick) {
  const std::int64_t oldest = frame_tick - ages_.front();
  past_.erase(std::remove_if(past_.begin(), past_.end(), [&](const Moment& each) { return each.tick < oldest; }),
              past_.end());
  past_.push_back(std::move(moment));
}

std::vector<Exposure::Sample> Exposure::samplesOf(const Moment& present) const {
  std::vector<Sample> samples;
  for (const std::int64_t age : ages_) {
    const auto noted =
        std::find_if(past_.begin(), past_.end(), [&](const Moment& each) { return each.tick >= present.tick - age; });
    const Moment* moment = noted == past_.end() ? &present : &*noted;
    if (samples.empty() || samples.back().moment != moment) samples.push_back({moment, 0});
    ++samples.back().count;
  }
  return samples;
}

void ImageMean::add(const Image& image, std::uint32_t count) {
  sums_.resize(image.data.size());
  for (std::size_t i = 0; i < sums_.size(); ++i) sums_[i] += count * image.data[i];
  count_ += count;
}

void ImageMean::write(Image& image) const {
  for (std::size_t i = 0; i < sums_.size(); ++i) {
    image.data[i] = static_cast<std::uint8_t>((sums_[i] + count_ / 2) / count_);
  }
}

}  // namespace aras_visual_servo_sim
