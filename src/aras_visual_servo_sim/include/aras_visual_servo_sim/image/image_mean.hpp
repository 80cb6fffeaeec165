#pragma once

#include <cstdint>
#include <vector>

#include "aras_visual_servo_sim/image/image.hpp"

namespace aras_visual_servo_sim {

/** Mean of images of one size, each byte by itself, rounded once. */
class ImageMean {
 public:
  void add(const Image& image, std::uint32_t count);
  /** Writes the mean, a half rounded up, over an image of the same size. @pre something was added */
  void write(Image& image) const;

 private:
  std::vector<std::uint32_t> sums_;
  std::uint32_t count_ = 0;
};

}  // namespace aras_visual_servo_sim
