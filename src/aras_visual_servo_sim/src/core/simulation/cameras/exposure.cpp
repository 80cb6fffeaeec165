#include "aras_visual_servo_sim/simulation/cameras/exposure.hpp"

#include <algorithm>
#include <cmath>

namespace aras_visual_servo_sim {

Moment momentOf(std::int64_t tick, const Pose& X_WC, const Scene& scene) {
  Moment moment{tick, X_WC, {}, {}, {}};
  for (const PlanarModel& model : scene.models) moment.models.push_back(model.X_WM);
  for (const Body& body : scene.bodies) moment.bodies.push_back(body.X_WB);
  for (const Light& light : scene.lighting.lights) {
    if (!light.attached_to.empty()) moment.lights.push_back(light.X_WA);
  }
  return moment;
}

void show(const Moment& moment, Scene& scene) {
  for (std::size_t k = 0; k < moment.models.size(); ++k) scene.models[k].X_WM = moment.models[k];
  for (std::size_t k = 0; k < moment.bodies.size(); ++k) scene.bodies[k].X_WB = moment.bodies[k];
  auto carrier = moment.lights.begin();
  for (Light& light : scene.lighting.lights) {
    if (!light.attached_to.empty() && carrier != moment.lights.end()) light.carry(*carrier++);
  }
}

std::map<std::string, Pose> modelPoses(const Moment& moment, const ModelSet& set) {
  std::map<std::string, Pose> poses;
  for (std::size_t k = 0; k < moment.models.size(); ++k) poses[set.scene.models[k].name()] = moment.models[k];
  for (std::size_t k = 0; k < moment.bodies.size(); ++k) {
    if (set.body_links[k].isSolid()) poses[set.scene.bodies[k].name] = moment.bodies[k];
  }
  return poses;
}

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
