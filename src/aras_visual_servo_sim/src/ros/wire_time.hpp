#pragma once

#include <ros/time.h>

#include <cstdint>

#include "aras_visual_servo_sim/simulation.hpp"
#include "conversions.hpp"

namespace aras_visual_servo_sim {

/** Simulated time as the others see it: the simulation's own, which a reset turns back to 0, or one that never goes
 * back
 *  (`reset_clock: monotonic`). */
class WireTime {
 public:
  WireTime(const Simulation& simulation, bool monotonic) : simulation_(simulation), monotonic_(monotonic) {}

  /** Stamp of the present state. */
  ros::Time now() const { return toRosTime(offset_ns_ + simulation_.timeNs()); }
  /** The simulation's time at a stamp [ns]; negative for stamps from before the last reset of a monotonic clock. */
  std::int64_t simulated(const ros::Time& stamp) const { return toNanoseconds(stamp) - offset_ns_; }
  /** The simulation's time jumped, and was this before: a monotonic clock goes on one period later. */
  void jumped(std::int64_t before_ns) {
    if (monotonic_) offset_ns_ += before_ns + simulation_.periodNs() - simulation_.timeNs();
  }

 private:
  const Simulation& simulation_;
  bool monotonic_;
  std::int64_t offset_ns_ = 0;
};

}  // namespace aras_visual_servo_sim
