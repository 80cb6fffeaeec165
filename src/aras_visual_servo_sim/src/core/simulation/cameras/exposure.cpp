#include "aras_visual_servo_sim/simulation/cameras/exposure.hpp"

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

Exposure Exposure::ofRows(double all_s, std::int64_t period_ns) {
  const std::int64_t all_ns = std::llround(1e9 * all_s);
  Exposure exposure;
  for (std::int64_t age = (all_ns + period_ns - 1) / period_ns; age >= 0; --age) exposure.ages_.push_back(age);
  return exposure;
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

}  // namespace aras_visual_servo_sim
