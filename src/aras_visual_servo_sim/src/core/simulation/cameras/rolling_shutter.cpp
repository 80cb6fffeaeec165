#include "rolling_shutter.hpp"

#include <algorithm>

namespace aras_visual_servo_sim {
namespace {

bool same(const Pose& a, const Pose& b) { return a.p == b.p && a.q.coeffs() == b.q.coeffs(); }

bool same(const std::vector<Pose>& a, const std::vector<Pose>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const Pose& x, const Pose& y) { return same(x, y); });
}

Pose between(const Pose& a, const Pose& b, double share) {
  if (same(a, b)) return a;
  return {a.p + share * (b.p - a.p), a.q.slerp(share, b.q)};
}

void between(const std::vector<Pose>& a, const std::vector<Pose>& b, double share, std::vector<Pose>& poses) {
  poses.resize(a.size());
  for (std::size_t k = 0; k < a.size(); ++k) poses[k] = between(a[k], b[k], share);
}

}  // namespace

RollingShutter::RollingShutter(const CameraConfig& config, const std::vector<Exposure::Sample>& moments,
                               std::int64_t period_ns)
    : moments_(moments),
      last_row_(config.height - 1),
      samples_(config.exposure_s > 0.0 ? config.exposure_samples : 1),
      row_ticks_(1e9 * config.sensor->row_time_s / static_cast<double>(period_ns)),
      exposure_ticks_(1e9 * config.exposure_s / static_cast<double>(period_ns)) {}

bool RollingShutter::still() const {
  const Moment& last = *moments_.back().moment;
  return std::all_of(moments_.begin(), moments_.end(), [&last](const Exposure::Sample& each) {
    const Moment& moment = *each.moment;
    return same(moment.X_WC, last.X_WC) && same(moment.models, last.models) && same(moment.bodies, last.bodies) &&
           same(moment.lights, last.lights);
  });
}

double RollingShutter::age(int v, int sample) const {
  return (last_row_ - v) * row_ticks_ + (samples_ - sample - 0.5) / samples_ * exposure_ticks_;
}

void RollingShutter::find(int v, int sample, Moment& moment) const {
  const double tick = static_cast<double>(moments_.back().moment->tick) - age(v, sample);
  const auto after = std::find_if(moments_.begin(), moments_.end(), [tick](const Exposure::Sample& each) {
    return static_cast<double>(each.moment->tick) >= tick;
  });
  const Moment& b = after == moments_.end() ? *moments_.back().moment : *after->moment;
  const Moment& a = after == moments_.begin() || after == moments_.end() ? b : *(after - 1)->moment;
  const double share =
      a.tick == b.tick ? 0.0 : (tick - static_cast<double>(a.tick)) / static_cast<double>(b.tick - a.tick);
  moment.tick = b.tick;
  moment.X_WC = between(a.X_WC, b.X_WC, share);
  between(a.models, b.models, share, moment.models);
  between(a.bodies, b.bodies, share, moment.bodies);
  between(a.lights, b.lights, share, moment.lights);
}

}  // namespace aras_visual_servo_sim
