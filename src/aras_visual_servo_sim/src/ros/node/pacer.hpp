#pragma once

#include <ros/time.h>

#include <cstdint>

namespace aras_visual_servo_sim {

/** Keeps simulated time at a multiple of wall time. A simulator that falls behind by more than 0.1 s of wall time does
 * not catch up: the difference is forgotten. */
class Pacer {
 public:
  /** @param real_time_factor  simulated over wall time, >= 0; 0 = never wait */
  explicit Pacer(double real_time_factor) : factor_(real_time_factor) {}

  /** Another factor, from now on. */
  void setFactor(double real_time_factor, std::int64_t time_ns) {
    factor_ = real_time_factor;
    restart(time_ns);
  }

  bool paced() const { return factor_ > 0.0; }

  /** Begins anew at this time; to be called after a start, a pause or a reset. */
  void restart(std::int64_t time_ns);

  /** @return wall time to wait before simulated time may pass time_ns; 0 if there is none [s] */
  double ahead(std::int64_t time_ns);

 private:
  double factor_;
  std::int64_t start_ns_ = 0;
  ros::WallTime start_;
};

/** Simulated over wall time, reached over the last second of wall time. */
class RateMeter {
 public:
  void restart(std::int64_t time_ns);
  /** Call at an even pace of 10 Hz. @return the factor, 0 before anything was measured */
  double update(std::int64_t time_ns);

 private:
  static constexpr int kSlots = 10;
  struct Sample {
    ros::WallTime wall;
    std::int64_t time_ns = 0;
  };
  Sample samples_[kSlots];
  int count_ = 0;
  int next_ = 0;
};

}  // namespace aras_visual_servo_sim
