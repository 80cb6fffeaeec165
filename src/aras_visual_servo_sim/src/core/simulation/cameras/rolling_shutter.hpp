#pragma once

#include <cstdint>
#include <vector>

#include "aras_visual_servo_sim/camera/camera_config.hpp"
#include "aras_visual_servo_sim/simulation/cameras/exposure.hpp"

namespace aras_visual_servo_sim {

/** When each row of an image is exposed, and where everything was then.
 *
 *  The shutter of the last row closes at the stamp T, that of row v at T - (height - 1 - v) row_time_s; each is open
 * for exposure_s, which is cut into exposure_samples equal parts as Exposure does. Between two ticks everything moves
 * on a straight line and turns about a fixed axis at constant speed: of a motion with acceleration a this is off by a
 * period^2 / 8. Before the first moment everything is where it was then. */
class RollingShutter {
 public:
  /** @param moments  in the order of time, the last one at T; they outlive this object, none is empty */
  RollingShutter(const CameraConfig& config, const std::vector<Exposure::Sample>& moments, std::int64_t period_ns);

  /** Whether nothing moved: all rows see the same. */
  bool still() const;
  /** How many instants make up a row. */
  int samples() const { return samples_; }
  /** Age of an instant of row v at T [ticks]. */
  double age(int v, int sample) const;
  /** Where everything was then. @param moment  of no meaning but for its poses */
  void find(int v, int sample, Moment& moment) const;

 private:
  const std::vector<Exposure::Sample>& moments_;
  int last_row_, samples_;
  double row_ticks_, exposure_ticks_;
};

}  // namespace aras_visual_servo_sim
