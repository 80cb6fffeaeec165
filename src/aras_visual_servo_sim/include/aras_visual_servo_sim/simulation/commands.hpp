#pragma once

#include <cstdint>
#include <deque>
#include <limits>
#include <optional>
#include <string>
#include <utility>

#include "aras_visual_servo_sim/physics/multibody_world.hpp"

namespace aras_visual_servo_sim {

/** Takes the commands to the robot. Each is applied as a whole or refused as a whole. A refused command is counted, and
 *  all commanded velocities become 0, so that the arm stands still.
 *
 *  With a delay, a command acts that much later: its stamp is checked when it comes, and what it says of the joints
 * when it acts. `applyDue` is to be called at the time of `nextDueNs`. A refused command takes those with it that are
 * on their way. */
class Commands {
 public:
  /** A command on its way. */
  struct Held {
    std::int64_t due_ns;
    JointCommand command;
  };
  static constexpr std::int64_t kNeverNs = std::numeric_limits<std::int64_t>::max();

  /** @param timeout_s  age at which a command is too old; 0: never
   *  @param delay_s  how long a command is on its way, rounded up to whole periods  @param period_ns  of the physics */
  Commands(double timeout_s, double delay_s, std::int64_t period_ns);
  /** Commands may be older by this latency, because they may answer an image of the slowest camera. */
  void allowLatency(std::int64_t latency_ns) { latency_ns_ = latency_ns; }

  /** @param stamp_ns  time of the state it answers; nothing: now
   *  @throws ParameterError for a stamp in the future or too old; NotFiniteError, UnknownNameError, ParameterError as
   *          MultibodyWorld::setCommand */
  void apply(const JointCommand& command, std::optional<std::int64_t> stamp_ns, std::int64_t now_ns,
             MultibodyWorld& world);
  /** When the next command acts that is on its way; kNeverNs: there is none. */
  std::int64_t nextDueNs() const { return held_.empty() ? kNeverNs : held_.front().due_ns; }
  /** Lets the commands act that are due. One that the world does not take is refused; nothing is thrown. */
  void applyDue(std::int64_t now_ns, MultibodyWorld& world);
  bool delays() const { return delay_ns_ > 0; }
  const std::deque<Held>& held() const { return held_; }
  void restoreHeld(std::deque<Held> held) { held_ = std::move(held); }
  /** Forgets the commands on their way. */
  void drop() { held_.clear(); }
  /** As a Float64 on a controller's command topic, which comes without delay. */
  void apply(const std::string& controller, double value, MultibodyWorld& world);
  /** Counts a command that could not even be read. */
  void refuse(const std::string& reason, MultibodyWorld& world);

  std::uint64_t refused() const { return refused_; }
  const std::string& lastRefusal() const { return last_refusal_; }
  void restore(std::uint64_t refused, const std::string& last_refusal);

 private:
  void checkAge(std::int64_t age_ns, bool may_be_old, std::int64_t now_ns) const;
  template <typename Action>
  void acceptOrRefuse(const Action& action, MultibodyWorld& world);

  double timeout_s_;
  std::int64_t delay_ns_;
  std::deque<Held> held_;
  std::int64_t latency_ns_ = 0;
  std::uint64_t refused_ = 0;
  std::string last_refusal_;
};

}  // namespace aras_visual_servo_sim
