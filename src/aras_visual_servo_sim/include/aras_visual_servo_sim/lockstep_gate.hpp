#pragma once

#include <cstdint>
#include <optional>

namespace aras_visual_servo_sim {

/** Decides when a simulator in lockstep holds: after each image, until a command stamped at or after the image came.
 *
 *  Unarmed (free running) until the first command. A command counts for an image only if it arrives after the image
 *  went out: what was sent before cannot have seen it, whatever its stamp.
 */
class LockstepGate {
 public:
  explicit LockstepGate(bool enabled) : enabled_(enabled) {}

  bool armed() const { return armed_; }
  bool holding() const { return waiting_ns_.has_value(); }
  /** Stamp of the image that waits for its answer [ns]. @pre holding() */
  std::int64_t waitingForNs() const { return *waiting_ns_; }

  /** An image stamped so went out. */
  void imageSent(std::int64_t stamp_ns) {
    if (armed_) waiting_ns_ = stamp_ns;
  }

  /** A command stamped so came, accepted or not: whoever sent it is alive. */
  void commandReceived(std::int64_t stamp_ns) {
    armed_ = enabled_;
    if (waiting_ns_ && stamp_ns >= *waiting_ns_) waiting_ns_.reset();
  }

  /** Goes on without the answer. */
  void release() { waiting_ns_.reset(); }

  /** As constructed: unarmed. */
  void reset() {
    armed_ = false;
    waiting_ns_.reset();
  }

 private:
  bool enabled_;
  bool armed_ = false;
  std::optional<std::int64_t> waiting_ns_;
};

}  // namespace aras_visual_servo_sim
