#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "aras_visual_servo_sim/image/image.hpp"

namespace aras_visual_servo_sim {

/** Mean of images of one size, each value by itself, rounded once. */
class ImageMean {
 public:
  /** @pre the counts of all images sum up to 65536 at most */
  template <typename Value>
  void add(const ImageOf<Value>& image, std::uint32_t count) {
    sums_.resize(image.data.size());
    for (std::size_t i = 0; i < sums_.size(); ++i) sums_[i] += count * image.data[i];
    count_ += count;
  }

  /** Writes the mean, a half rounded up, over an image of the same size. @pre something was added */
  template <typename Value>
  void write(ImageOf<Value>& image) const {
    for (std::size_t i = 0; i < sums_.size(); ++i) {
      image.data[i] = static_cast<Value>((sums_[i] + count_ / 2) / count_);
    }
  }

 private:
  std::vector<std::uint32_t> sums_;
  std::uint32_t count_ = 0;
};

}  // namespace aras_visual_servo_sim
