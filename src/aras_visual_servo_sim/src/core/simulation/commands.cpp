#include "aras_visual_servo_sim/simulation/commands.hpp"

#include <cmath>
#include <limits>

#include "aras_visual_servo_sim/config/errors.hpp"

namespace aras_visual_servo_sim {

namespace {

/** now - stamp, or the longest time that there is where that is longer. */
std::int64_t ageOf(std::int64_t stamp_ns, std::int64_t now_ns) {
  std::int64_t age_ns = 0;
  if (!__builtin_sub_overflow(now_ns, stamp_ns, &age_ns)) return age_ns;
  return stamp_ns < 0 ? std::numeric_limits<std::int64_t>::max() : std::numeric_limits<std::int64_t>::min();
}

}  // namespace

Commands::Commands(double timeout_s, double delay_s, std::int64_t period_ns)
    : timeout_s_(timeout_s), delay_ns_((std::llround(1e9 * delay_s) + period_ns - 1) / period_ns * period_ns) {}

void Commands::refuse(const std::string& reason, MultibodyWorld& world) {
  ++refused_;
  last_refusal_ = reason;
  drop();
  world.hold();
}

template <typename Action>
void Commands::acceptOrRefuse(const Action& action, MultibodyWorld& world) {
  try {
    action();
  } catch (const ArasError& error) {
    refuse(error.what(), world);
    throw;
  }
}

void Commands::checkAge(std::int64_t age_ns, bool may_be_old, std::int64_t now_ns) const {
  const auto seconds = [](std::int64_t ns) { return 1e-9 * static_cast<double>(ns); };
  const double age_s = seconds(age_ns),
               late_s = 1e-9 * (static_cast<double>(age_ns) - static_cast<double>(latency_ns_));
  if (age_s < 0.0) {
    throw ParameterError("command: stamp is " + std::to_string(-age_s) + " s in the future, now is " +
                         std::to_string(seconds(now_ns)) + " s of simulated time");
  }
  if (!may_be_old && timeout_s_ > 0.0 && late_s > timeout_s_) {
    throw ParameterError("command: stamp is " + std::to_string(age_s) + " s old, allowed <= " +
                         std::to_string(timeout_s_ + age_s - late_s) + " s (sim/command_timeout_s" +
                         (latency_ns_ > 0 ? " and the longest latency_s of a camera)" : ")"));
  }
}

void Commands::apply(const JointCommand& command, std::optional<std::int64_t> stamp_ns, std::int64_t now_ns,
                     MultibodyWorld& world) {
  acceptOrRefuse(
      [&] {
        checkAge(ageOf(stamp_ns.value_or(now_ns), now_ns), command.empty(), now_ns);
        if (delay_ns_ == 0) return world.setCommand(command);
        if (!command.empty()) held_.push_back({now_ns + delay_ns_, command});
      },
      world);
}

void Commands::applyDue(std::int64_t now_ns, MultibodyWorld& world) {
  while (nextDueNs() <= now_ns) {
    const JointCommand command = std::move(held_.front().command);
    held_.pop_front();
    try {
      world.setCommand(command);
    } catch (const ArasError& error) {  // its controller was stopped in the meantime
      refuse(error.what(), world);
    }
  }
}

void Commands::apply(const std::string& controller, double value, MultibodyWorld& world) {
  acceptOrRefuse([&] { world.setControllerCommand(controller, value); }, world);
}

void Commands::restore(std::uint64_t refused, const std::string& last_refusal) {
  refused_ = refused;
  last_refusal_ = last_refusal;
}

}  // namespace aras_visual_servo_sim
