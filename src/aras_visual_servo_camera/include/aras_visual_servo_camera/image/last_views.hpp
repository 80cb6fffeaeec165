#pragma once

#include <cstddef>
#include <cstdint>
#include <iomanip>
#include <sstream>
#include <string>
#include <vector>

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
    if (count_ > 0 && stamp_ns < newest().stamp_ns) count_ = 0;
    if (count_ == 0 || stamp_ns != newest().stamp_ns) {
      if (kept_.size() < kKept && count_ == kept_.size()) kept_.emplace_back();
      newest_ = count_ == 0 ? 0 : (newest_ + 1) % kKept;
      if (count_ < kKept) ++count_;
    }
    kept_[newest_].stamp_ns = stamp_ns;
    return kept_[newest_].view;
  }

  /** @throws ParameterError if no image of this stamp is kept */
  const View& at(std::int64_t stamp_ns) const {
    for (std::size_t k = 0; k < count_; ++k)
      if (kept_[k].stamp_ns == stamp_ns) return kept_[k].view;
    std::string allowed = "allowed after an image with a stamp";
    if (count_ > 0) {
      const std::int64_t oldest_ns = kept_[(newest_ + 1) % count_].stamp_ns;
      allowed = "allowed the stamp of one of the last " + std::to_string(count_) + " images, from " +
                seconds(oldest_ns) + " to " + seconds(newest().stamp_ns);
    }
    throw ParameterError("reference.stamp: found " + seconds(stamp_ns) + ", " + allowed);
  }

  void clear() { count_ = 0; }

 private:
  struct Kept {
    std::int64_t stamp_ns;
    View view;
  };

  const Kept& newest() const { return kept_[newest_]; }

  static std::string seconds(std::int64_t stamp_ns) {
    std::ostringstream text;
    text << std::fixed << std::setprecision(9) << 1e-9 * static_cast<double>(stamp_ns) << " s";
    return text.str();
  }

  std::vector<Kept> kept_;              // a ring; the first count_ of them are in use
  std::size_t count_ = 0, newest_ = 0;  // newest_: its index
};

}  // namespace aras_visual_servo_camera
