#pragma once

#include <cstdint>

#include "aras_visual_servo_sim/camera/camera_config.hpp"
#include "aras_visual_servo_sim/simulation/cameras/frame_schedule.hpp"
#include "aras_visual_servo_sim/simulation/time/clock.hpp"

namespace aras_visual_servo_sim {

/** Which frames a camera exposes, and which it has exposed: those of its schedule, without the ones that are dropped;
 *  of a triggered camera only those that somebody asked for. */
class FramePlan {
 public:
  /** Everything on which the frames to come depend. */
  struct State {
    std::int64_t next = 0;  ///< smallest index that is neither exposed nor passed over
    bool asked = false;     ///< of a triggered camera: one frame is wanted
    std::uint64_t dropped = 0;
  };

  /** @param drop_seed  decides which frames are dropped @throws ParameterError for a rate beyond that of the ticks */
  FramePlan(const CameraConfig& config, std::int64_t period_ns, std::uint64_t drop_seed);

  /** The frame that comes next: its index and its tick, kNeverTick for a triggered camera that nobody asked. */
  std::int64_t nextIndex() const { return keptFrom(state_.next); }
  std::int64_t nextTick() const;
  /** The next frame is exposed, or missed. @return its index */
  std::int64_t pass();
  /** Whether the frame passed last is that of this tick. */
  bool passedAt(std::int64_t tick) const;
  /** Asks a triggered camera for one frame: the first of its schedule after `tick`. To ask again before that frame has
   *  been taken changes nothing, and neither does asking a camera that is not triggered. */
  void trigger(std::int64_t tick);

  /** The first frame of the schedule at or after a tick, dropped or not, asked for or not. */
  std::int64_t indexFrom(std::int64_t tick) const { return schedule_.firstIndexFrom(tick); }
  std::int64_t tickFrom(std::int64_t tick) const { return schedule_.tickOf(indexFrom(tick)); }

  /** Whether a camera of this plan can be in a state at a tick >= 0: its next frame is neither before that tick nor
   * later than the first after it. */
  bool canBe(const State& state, std::int64_t tick) const;

  const State& state() const { return state_; }
  void setState(const State& state) { state_ = state; }

 private:
  bool isDropped(std::int64_t index) const;
  /** The first index >= this one that is not dropped. */
  std::int64_t keptFrom(std::int64_t index) const;

  FrameSchedule schedule_;
  double drop_probability_;
  std::uint64_t drop_seed_;
  bool triggered_;
  State state_;
};

}  // namespace aras_visual_servo_sim
