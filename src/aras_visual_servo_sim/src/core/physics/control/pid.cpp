#include "aras_visual_servo_sim/physics/pid.hpp"

#include <algorithm>
#include <cmath>

namespace aras_visual_servo_sim {

double Pid::compute(double error, double dt_s) {
  if (dt_s == 0.0 || !std::isfinite(error)) return 0.0;
  double error_dot = state_.error_dot;
  if (dt_s > 0.0) {
    if (state_.last_error_valid) error_dot = (error - state_.last_error) / dt_s;
    state_.last_error = error;
    state_.last_error_valid = true;
  }
  return compute(error, error_dot, dt_s);
}

double Pid::compute(double error, double error_dot, double dt_s) {
  state_.error = error;
  state_.error_dot = error_dot;
  if (dt_s == 0.0 || !std::isfinite(error) || !std::isfinite(error_dot)) return 0.0;

  state_.integral += dt_s * error;
  if (gains_.antiwindup && gains_.i != 0.0) {
    const double one = gains_.i_min / gains_.i;
    const double other = gains_.i_max / gains_.i;
    state_.integral = std::clamp(state_.integral, std::min(one, other), std::max(one, other));
  }
  double integral_term = gains_.i * state_.integral;
  if (!gains_.antiwindup) integral_term = std::clamp(integral_term, gains_.i_min, gains_.i_max);

  state_.command = gains_.p * error + integral_term + gains_.d * error_dot;
  return state_.command;
}

}  // namespace aras_visual_servo_sim
