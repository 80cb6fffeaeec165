#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <iomanip>
#include <sstream>
#include <string>
#include <utility>

#include "aras_visual_servo_camera/config/errors.hpp"

namespace aras_visual_servo_camera {

/** Stamp of an image that carries none. Nothing is kept of such an image. */
constexpr std::int64_t kNoStamp = -1;

/** Keeps of the last images what is needed to make one of them the reference. An image is found by its stamp [ns].
 *  Memory of views that were dropped is used again. */
template <class View>
class LastViews {
 public:
  static constexpr std::size_t kKept = 32;  ///< one second at 30 Hz

  /** The place of a new image, to be filled; when all are taken, that of the oldest image. A stamp before the newest
   * one means that time was set back: the images before belong to another run and are forgotten. */
  View& add(std::int64_t stamp_ns) {
    if (!kept_.empty() && stamp_ns < kept_.back().stamp_ns) kept_.clear();
    if (kept_.size() == kKept && stamp_ns != kept_.back().stamp_ns) {
      kept_.push_back(std::move(kept_.front()));
      kept_.pop_front();
    } else if (kept_.empty() || stamp_ns != kept_.back().stamp_ns) {
      kept_.emplace_back();
    }
    kept_.back().stamp_ns = stamp_ns;
    return kept_.back().view;
  }

  /** @throws ParameterError if no image of this stamp is kept */
  const View& at(std::int64_t stamp_ns) const {
    for (const Kept& kept : kept_)
      if (kept.stamp_ns == stamp_ns) return kept.view;
    const std::string found = "reference.stamp: found " + seconds(stamp_ns) + ", allowed ";
    if (kept_.empty()) throw ParameterError(found + "after an image with a stamp");
    throw ParameterError(found + "the stamp of one of the last " + std::to_string(kept_.size()) + " images, from " +
                         seconds(kept_.front().stamp_ns) + " to " + seconds(kept_.back().stamp_ns));
  }

  void clear() { kept_.clear(); }

 private:
  struct Kept {
    std::int64_t stamp_ns;
    View view;
  };

  static std::string seconds(std::int64_t stamp_ns) {
    std::ostringstream text;
    text << std::fixed << std::setprecision(9) << 1e-9 * static_cast<double>(stamp_ns) << " s";
    return text.str();
  }

  std::deque<Kept> kept_;  // from the oldest to the newest
};

}  // namespace aras_visual_servo_camera
