#include "picture_window.hpp"

#include <algorithm>
#include <cmath>

#include "render/view/pixel_box.hpp"

namespace aras_visual_servo_sim {

int wrapped(Wrap wrap, double x, int size) {
  if (wrap == Wrap::kClamp) return static_cast<int>(held(x, 0.0, size - 1.0));
  const double turns = std::floor(x / size);
  const int index = static_cast<int>(held(x - turns * size, 0.0, size - 1.0));
  const bool turned = wrap == Wrap::kMirror && std::fmod(std::abs(turns), 2.0) == 1.0;
  return turned ? size - 1 - index : index;
}

template <int channels>
bool PictureWindow<channels>::place(const Texture& texture, Wrap wrap_s, Wrap wrap_t, const Eigen::Array2d& low,
                                    const Eigen::Array2d& high) {
  origin_ = low.floor();
  // One more than is reached: coordinates in single precision may be rounded up.
  const Eigen::Array2d size = high.floor() - origin_ + 2.0;
  constexpr double kFarthest = 1e9;  // [texels] beyond, they mean nothing in double precision
  if (!((size <= kMost).all() && (origin_.abs() < kFarthest).all())) return false;
  width_ = static_cast<int>(size[0]);
  height_ = static_cast<int>(size[1]);
  stride_ = width_ + 1;
  inside_ =
      (origin_ >= 0.0).all() && origin_[0] + width_ <= texture.width() && origin_[1] + height_ <= texture.height();
  for (int i = 0; i < width_; ++i) {
    columns_[i] = inside_ ? static_cast<int>(origin_[0]) + i : wrapped(wrap_s, origin_[0] + i, texture.width());
  }
  for (int j = 0; j < height_; ++j) {
    rows_[j] = inside_ ? static_cast<int>(origin_[1]) + j : wrapped(wrap_t, origin_[1] + j, texture.height());
  }
  sums_.resize(std::max(sums_.size(), std::size_t(stride_) * height_));
  plain_ = findPlain(texture);
  if (plain_) height_ = 1;  // its colour is all that is asked for
  inside_ ? copy(texture) : gather(texture);
  return true;
}

template <int channels>
bool PictureWindow<channels>::findPlain(const Texture& texture) const {
  const std::uint8_t* first = texture.texel(columns_[0], rows_[0]);
  for (int j = 0; j < height_; ++j) {
    for (int i = 0; i < width_; ++i) {
      if (!std::equal(first, first + 3, texture.texel(columns_[i], rows_[j]))) return false;
    }
  }
  return true;
}

template <int channels>
void PictureWindow<channels>::copy(const Texture& texture) {
  const std::size_t row_size = std::size_t(texture.width() + 1) * channels;
  Value* out = sums_.data();
  for (int j = 0; j < height_; ++j) {
    const std::int32_t* sums =
        texture.levels(channels)[0].sums.data() + rows_[j] * row_size + std::size_t(columns_[0]) * channels;
    const auto base = Lanes::load(sums);
    for (int i = 0; i < stride_; ++i, sums += channels) *out++ = Lanes::real(Lanes::load(sums) - base);
  }
}

template <int channels>
void PictureWindow<channels>::gather(const Texture& texture) {
  const std::size_t row_size = std::size_t(texture.width() + 1) * channels;
  Value* out = sums_.data();
  for (int j = 0; j < height_; ++j) {
    const std::int32_t* row = texture.levels(channels)[0].sums.data() + rows_[j] * row_size;
    Value sum{};
    for (int i = 0; i < width_; ++i) {
      *out++ = sum;
      const std::int32_t* texel = row + std::size_t(columns_[i]) * channels;
      sum += Lanes::real(Lanes::load(texel + channels) - Lanes::load(texel));
    }
    *out++ = sum;
  }
}

template class PictureWindow<1>;
template class PictureWindow<3>;

}  // namespace aras_visual_servo_sim
