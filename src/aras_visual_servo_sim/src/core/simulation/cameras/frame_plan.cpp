#include "aras_visual_servo_sim/simulation/cameras/frame_plan.hpp"

#include <algorithm>

#include "aras_visual_servo_sim/config/splitmix.hpp"

namespace aras_visual_servo_sim {

FramePlan::FramePlan(const CameraConfig& config, std::int64_t period_ns, std::uint64_t drop_seed)
    : schedule_(config.rate_hz, period_ns),
      drop_probability_(config.drop_probability),
      drop_seed_(drop_seed),
      triggered_(config.triggered) {}

bool FramePlan::isDropped(std::int64_t index) const {
  if (drop_probability_ <= 0.0) return false;
  using splitmix::kGolden;
  using splitmix::mix;
  const std::uint64_t draw = mix(mix(drop_seed_ + kGolden) ^ (static_cast<std::uint64_t>(index) * kGolden + 1));
  return static_cast<double>(draw >> 11) < drop_probability_ * 0x1p53;
}

std::int64_t FramePlan::keptFrom(std::int64_t index) const {
  while (isDropped(index)) ++index;
  return index;
}

bool FramePlan::canBe(const State& state, std::int64_t tick) const {
  if (state.next < 0 || state.next > schedule_.firstIndexFrom(tick + 1)) return false;
  return (triggered_ && !state.asked) || schedule_.tickOf(keptFrom(state.next)) >= tick;
}

std::int64_t FramePlan::nextTick() const {
  return triggered_ && !state_.asked ? kNeverTick : schedule_.tickOf(nextIndex());
}

std::int64_t FramePlan::pass() {
  const std::int64_t index = nextIndex();
  state_.dropped += static_cast<std::uint64_t>(index - state_.next);
  state_.next = index + 1;
  state_.asked = false;
  return index;
}

bool FramePlan::passedAt(std::int64_t tick) const {
  return state_.next > 0 && !state_.asked && schedule_.tickOf(state_.next - 1) == tick;
}

void FramePlan::trigger(std::int64_t tick) {
  if (!triggered_ || state_.asked) return;
  state_.asked = true;
  state_.next = std::max(state_.next, schedule_.firstIndexFrom(tick + 1));
}

}  // namespace aras_visual_servo_sim
