#include "aras_visual_servo_sim/image/image_mean.hpp"

namespace aras_visual_servo_sim {

void ImageMean::add(const Image& image, std::uint32_t count) {
  sums_.resize(image.data.size());
  for (std::size_t i = 0; i < sums_.size(); ++i) sums_[i] += count * image.data[i];
  count_ += count;
}

void ImageMean::write(Image& image) const {
  for (std::size_t i = 0; i < sums_.size(); ++i) {
    image.data[i] = static_cast<std::uint8_t>((sums_[i] + count_ / 2) / count_);
  }
}

}  // namespace aras_visual_servo_sim
