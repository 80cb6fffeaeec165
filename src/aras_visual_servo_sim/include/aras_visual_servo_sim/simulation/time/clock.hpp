#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <string>

#include "aras_visual_servo_sim/config/errors.hpp"

namespace aras_visual_servo_sim {

/** The tick that stands for "never". */
inline constexpr std::int64_t kNeverTick = std::numeric_limits<std::int64_t>::max();

/** Simulated time: ticks of a whole number of nanoseconds. */
class Clock {
 public:
  /** @throws ParameterError unless the period is a whole number of nanoseconds, > 0 */
  explicit Clock(double period_s) {
    constexpr double kNanosecondsPerSecond = 1e9;
    constexpr double kRounding = 1e-3;  // [ns] of period_s times 1e9, far below one nanosecond
    const double period_ns = period_s * kNanosecondsPerSecond;
    period_ns_ = std::llround(period_ns);
    if (period_ns_ < 1 || std::abs(period_ns - static_cast<double>(period_ns_)) > kRounding) {
      throw ParameterError("sim/period_s: found " + std::to_string(period_s) +
                           ", allowed a whole number of nanoseconds");
    }
  }

  std::int64_t periodNs() const { return period_ns_; }
  std::int64_t ns(std::int64_t tick) const { return tick * period_ns_; }

 private:
  std::int64_t period_ns_;
};

}  // namespace aras_visual_servo_sim
