#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "aras_visual_servo_sim/physics/multibody_world.hpp"

namespace aras_visual_servo_sim {

/** Takes the commands to the robot. Each is applied as a whole or refused as a whole. A refused command is counted, and
 *  all commanded velocities become 0, so that the arm stands still. */
class Commands {
 public:
  /** @param timeout_s  age at which a command is too old; 0: never */
  explicit Commands(double timeout_s) : timeout_s_(timeout_s) {}
  /** Commands may be older by this latency, because they may answer an image of the slowest camera. */
  void allowLatency(std::int64_t latency_ns) { latency_ns_ = latency_ns; }

  /** @param stamp_ns  time of the state it answers; nothing: now
   *  @throws ParameterError for a stamp in the future or too old; NotFiniteError, UnknownNameError, ParameterError as
   *          MultibodyWorld::setCommand */
  void apply(const JointCommand& command, std::optional<std::int64_t> stamp_ns, std::int64_t now_ns,
             MultibodyWorld& world);
  /** As a Float64 on a controller's command topic. */
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
  std::int64_t latency_ns_ = 0;
  std::uint64_t refused_ = 0;
  std::string last_refusal_;
};

}  // namespace aras_visual_servo_sim
