#include "pacer.hpp"

namespace aras_visual_servo_sim {
namespace {

constexpr double kForgottenLagS = 0.1;  // wall

}  // namespace

void Pacer::restart(std::int64_t time_ns) {
  start_ns_ = time_ns;
  start_ = ros::WallTime::now();
}

double Pacer::ahead(std::int64_t time_ns) {
  if (!paced()) return 0.0;
  const double due_s = 1e-9 * static_cast<double>(time_ns - start_ns_) / factor_;
  const double ahead_s = due_s - (ros::WallTime::now() - start_).toSec();
  if (ahead_s < -kForgottenLagS) restart(time_ns);
  return ahead_s > 0.0 ? ahead_s : 0.0;
}

void RateMeter::restart(std::int64_t time_ns) {
  count_ = next_ = 0;
  update(time_ns);
}

double RateMeter::update(std::int64_t time_ns) {
  const Sample now{ros::WallTime::now(), time_ns};
  const Sample oldest = count_ < kSlots ? samples_[0] : samples_[next_];
  samples_[next_] = now;
  next_ = (next_ + 1) % kSlots;
  if (count_ < kSlots) ++count_;
  if (count_ < 2) return 0.0;
  const double wall_s = (now.wall - oldest.wall).toSec();
  return wall_s > 0.0 ? 1e-9 * static_cast<double>(now.time_ns - oldest.time_ns) / wall_s : 0.0;
}

}  // namespace aras_visual_servo_sim
