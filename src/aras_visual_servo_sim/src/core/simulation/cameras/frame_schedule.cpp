#include "aras_visual_servo_sim/simulation/cameras/frame_schedule.hpp"

#include <cmath>
#include <string>

#include "aras_visual_servo_sim/config/errors.hpp"

namespace aras_visual_servo_sim {
namespace {

__extension__ using Wide = __int128;           // index * 10^15 outgrows 64 bits after two and a half hours at 1 Hz
constexpr std::int64_t kMicroHertz = 1000000;  // in one hertz
constexpr Wide kNanoPerMicroHertz = static_cast<Wide>(1000000000) * kMicroHertz;

}  // namespace

FrameSchedule::FrameSchedule(double rate_hz, std::int64_t period_ns) : rate_uhz_(0), period_ns_(period_ns) {
  if (period_ns <= 0) throw ParameterError("period: found " + std::to_string(period_ns) + " ns, allowed > 0");
  const double fastest_hz = 1e9 / static_cast<double>(period_ns);
  // 1 + 1e-9: a rate equal to the tick rate survives the division above.
  if (!std::isfinite(rate_hz) || rate_hz * kMicroHertz < 1.0 || rate_hz > fastest_hz * (1.0 + 1e-9)) {
    throw ParameterError("rate_hz: found " + std::to_string(rate_hz) +
                         ", allowed 0 < rate_hz <= " + std::to_string(fastest_hz) + " (one per physics period)");
  }
  rate_uhz_ = std::llround(rate_hz * kMicroHertz);
}

std::int64_t FrameSchedule::tickOf(std::int64_t index) const {
  const Wide step = static_cast<Wide>(rate_uhz_) * period_ns_;
  return static_cast<std::int64_t>((index * kNanoPerMicroHertz + step - 1) / step);
}

std::int64_t FrameSchedule::firstIndexFrom(std::int64_t tick) const {
  if (tick <= 0) return 0;
  // tickOf(index) >= tick  <=>  index > (tick - 1) * step / kNanoPerMicroHertz
  const Wide step = static_cast<Wide>(rate_uhz_) * period_ns_;
  return static_cast<std::int64_t>((tick - 1) * step / kNanoPerMicroHertz) + 1;
}

}  // namespace aras_visual_servo_sim
