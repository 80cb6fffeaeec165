#include "aras_visual_servo_sim/simulation/cameras/frames_in_flight.hpp"

#include <cmath>

namespace aras_visual_servo_sim {

FramesInFlight::FramesInFlight(double latency_s, std::int64_t period_ns)
    : latency_((std::llround(1e9 * latency_s) + period_ns - 1) / period_ns) {}

std::int64_t FramesInFlight::nextDelivery() const {
  return frames_.empty() ? kNeverTick : frames_.front().tick() + latency_;
}

const ExposedFrame& FramesInFlight::take() {
  taken_ = std::move(frames_.front());
  frames_.pop_front();
  return *taken_;
}

void FramesInFlight::passTo(std::int64_t tick) {
  while (nextDelivery() < tick) frames_.pop_front();
  if (taken_ && taken_->tick() + latency_ < tick) taken_.reset();
}

void FramesInFlight::keepModels(const std::shared_ptr<ModelSet>& models) {
  for (ExposedFrame& frame : frames_) {
    if (!frame.models) frame.models = models;
  }
  if (taken_ && !taken_->models) taken_->models = models;
}

void FramesInFlight::clear() { restore(std::nullopt, {}); }

void FramesInFlight::restore(std::optional<ExposedFrame> taken, std::deque<ExposedFrame> frames) {
  taken_ = std::move(taken);
  frames_ = std::move(frames);
}

}  // namespace aras_visual_servo_sim
