#pragma once

#include <ros/time.h>

#include <algorithm>
#include <cstdint>

#include "aras_visual_servo_sim/simulation/simulation.hpp"
#include "conversions.hpp"

namespace aras_visual_servo_sim {

/** Simulated time as it is on the wire: the simulation's own, which a reset turns back to 0, or one that never goes
 *  back (`reset_clock: monotonic`). */
class WireTime {
 public:
  WireTime(const Simulation& simulation, bool monotonic) : simulation_(simulation), monotonic_(monotonic) {}

  /** Stamp of the present state. */
  ros::Time now() const { return at(simulation_.timeNs()); }
  /** Stamp of the state at this time of the simulation's [ns]. */
  ros::Time at(std::int64_t time_ns) const { return toRosTime(offset_ns_ + time_ns); }
  /** The simulation's time at a stamp [ns]; negative for stamps from before the last reset of a monotonic clock. */
  std::int64_t simulated(const ros::Time& stamp) const { return toNanoseconds(stamp) - offset_ns_; }
  /** To be called when the simulation's time has jumped; it was before_ns. A monotonic clock goes on one period later,
   *  or as much later as the oldest image in flight needs to have a newer stamp than everything that was sent. */
  void jumped(std::int64_t before_ns) {
    if (!monotonic_) return;
    std::int64_t oldest_ns = simulation_.timeNs();
    for (const Camera& camera : simulation_.cameras()) {
      for (const ExposedFrame* frame : camera.lateFrames()) {
        oldest_ns = std::min(oldest_ns, frame->tick() * simulation_.periodNs());
      }
    }
    offset_ns_ += before_ns + simulation_.periodNs() - oldest_ns;
  }

 private:
  const Simulation& simulation_;
  bool monotonic_;
  std::int64_t offset_ns_ = 0;
};

}  // namespace aras_visual_servo_sim
