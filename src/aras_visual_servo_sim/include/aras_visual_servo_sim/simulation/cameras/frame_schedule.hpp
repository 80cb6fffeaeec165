#pragma once

#include <cstdint>

namespace aras_visual_servo_sim {

/** The physics ticks at which something periodic is sampled: frame k at the first tick >= k / rate. Integer arithmetic
 * throughout, so that frame times never drift: at 30 Hz and 1 ms the frames are at ticks 0, 34, 67, 100, 134, ... */
class FrameSchedule {
 public:
  /** @param rate_hz    0 < rate_hz <= one frame per tick, rounded to a micro-hertz [1/s]
   *  @param period_ns  physics period, > 0 [ns]
   *  @throws ParameterError  the rate is not positive, not finite, or faster than the ticks */
  FrameSchedule(double rate_hz, std::int64_t period_ns);

  /** @return the tick of frame `index` >= 0. */
  std::int64_t tickOf(std::int64_t index) const;

  /** @return the smallest index whose frame is not before `tick`. */
  std::int64_t firstIndexFrom(std::int64_t tick) const;

 private:
  std::int64_t rate_uhz_;
  std::int64_t period_ns_;
};

}  // namespace aras_visual_servo_sim
