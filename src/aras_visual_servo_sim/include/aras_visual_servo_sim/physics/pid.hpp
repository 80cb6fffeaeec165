#pragma once

namespace aras_visual_servo_sim {

/** Gains of control_toolbox::Pid. i_min <= 0 <= i_max bound the integral's part of the command; both 0: none. */
struct PidGains {
  double p = 0.0, i = 0.0, d = 0.0, i_min = 0.0, i_max = 0.0;
  bool antiwindup = false;  ///< clamp the accumulated error itself, not only its contribution
};

/** Memory of a Pid between calls; trivially copyable. */
struct PidState {
  double error = 0.0, last_error = 0.0, error_dot = 0.0, integral = 0.0, command = 0.0;
  bool last_error_valid = false;
};

/** The same as control_toolbox's PID: command = p e + clamp(i * integral of e) + d (e - e_last) / dt. */
class Pid {
 public:
  Pid() = default;
  explicit Pid(const PidGains& gains) : gains_(gains) {}

  /** @param error  set-point minus process value
   *  @param dt_s   time since the last call, > 0
   *  @return the command, 0 if the error is not finite or dt_s is 0 */
  double compute(double error, double dt_s);

  /** As above with the derivative of the error given. */
  double compute(double error, double error_dot, double dt_s);

  /** Forgets everything but the gains. */
  void reset() { state_ = PidState{}; }

  const PidGains& gains() const { return gains_; }
  void setGains(const PidGains& gains) { gains_ = gains; }
  const PidState& state() const { return state_; }
  void setState(const PidState& state) { state_ = state; }

 private:
  PidGains gains_;
  PidState state_;
};

}  // namespace aras_visual_servo_sim
