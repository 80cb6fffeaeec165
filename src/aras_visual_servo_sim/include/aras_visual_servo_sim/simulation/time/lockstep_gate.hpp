#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace aras_visual_servo_sim {

/** Decides when time stands still in lockstep: after each image, until every node that has to answer has sent a command
 *  with the image's stamp or a later one.
 *
 *  Until the first such command it is unarmed and time runs free. A command counts for an image only if it arrives
 * after the image was sent, whatever its stamp, because an earlier one cannot be an answer to it. */
class LockstepGate {
 public:
  /** @param nodes  nodes that have to answer each image; empty: one answer of any node is enough */
  explicit LockstepGate(bool enabled, const std::vector<std::string>& nodes = {})
      : enabled_(enabled), nodes_(nodes.begin(), nodes.end()) {}

  bool armed() const { return armed_; }
  bool holding() const { return waiting_ns_.has_value(); }
  /** Stamp of the image that waits for its answers [ns]. @pre holding() */
  std::int64_t waitingForNs() const { return *waiting_ns_; }
  /** Nodes that have to answer each image, sorted; empty: any node may. */
  const std::set<std::string>& nodes() const { return nodes_; }
  /** Those of them that have not answered yet, sorted. @pre holding() */
  const std::set<std::string>& missing() const { return missing_; }

  /** To be called when an image with this stamp was sent. */
  void imageSent(std::int64_t stamp_ns) {
    if (!armed_) return;
    waiting_ns_ = stamp_ns;
    missing_ = nodes_;
  }

  /** To be called when a command with this stamp arrived, accepted or refused: both show that its sender is alive. */
  void commandReceived(std::int64_t stamp_ns, const std::string& node = "") {
    if (!nodes_.empty() && nodes_.count(node) == 0) return;
    armed_ = enabled_;
    if (!waiting_ns_ || stamp_ns < *waiting_ns_) return;
    missing_.erase(node);
    if (missing_.empty()) waiting_ns_.reset();
  }

  /** Lets time go on without the missing answers. */
  void release() { waiting_ns_.reset(); }

  /** Back to unarmed. Named nodes that have answered before are then waited for from the first image on. */
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
