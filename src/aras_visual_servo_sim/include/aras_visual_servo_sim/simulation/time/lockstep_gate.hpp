#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace aras_visual_servo_sim {

/** Decides when a simulator in lockstep holds: after each image, until commands stamped at or after the image came from
 *  everybody who has to answer.
 *
 *  Unarmed (free running) until the first command of one of them. A command counts for an image only if it arrives
 * after the image went out: what was sent before cannot have seen it, whatever its stamp.
 */
class LockstepGate {
 public:
  /** @param nodes  who has to answer each image; empty: anybody, once */
  explicit LockstepGate(bool enabled, const std::vector<std::string>& nodes = {})
      : enabled_(enabled), nodes_(nodes.begin(), nodes.end()) {}

  bool armed() const { return armed_; }
  bool holding() const { return waiting_ns_.has_value(); }
  /** Stamp of the image that waits for its answers [ns]. @pre holding() */
  std::int64_t waitingForNs() const { return *waiting_ns_; }
  /** Who has to answer each image, sorted; empty: anybody. */
  const std::set<std::string>& nodes() const { return nodes_; }
  /** Who of them has not answered yet, sorted. @pre holding() */
  const std::set<std::string>& missing() const { return missing_; }

  /** An image stamped so went out. */
  void imageSent(std::int64_t stamp_ns) {
    if (!armed_) return;
    waiting_ns_ = stamp_ns;
    missing_ = nodes_;
  }

  /** A command stamped so came, accepted or not: whoever sent it is alive. */
  void commandReceived(std::int64_t stamp_ns, const std::string& node = "") {
    if (!nodes_.empty() && nodes_.count(node) == 0) return;
    armed_ = enabled_;
    if (!waiting_ns_ || stamp_ns < *waiting_ns_) return;
    missing_.erase(node);
    if (missing_.empty()) waiting_ns_.reset();
  }

  /** Goes on without the answers. */
  void release() { waiting_ns_.reset(); }

  /** As constructed: unarmed; nodes that were named and have answered once are waited for from the first image on. */
  void reset() {
    armed_ = armed_ && !nodes_.empty();
    waiting_ns_.reset();
  }

 private:
  bool enabled_;
  std::set<std::string> nodes_, missing_;
  bool armed_ = false;
  std::optional<std::int64_t> waiting_ns_;
};

}  // namespace aras_visual_servo_sim
