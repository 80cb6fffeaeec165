#pragma once

#include <array>

#include "picture_corners.hpp"
#include "picture_window.hpp"

namespace aras_visual_servo_sim {

/** Means of a picture over the pixels of a tile, each a quadrangle on it with straight edges.
 *
 *  By Green's theorem the integral of the texels over a quadrangle is that of their running sums along its edges.
 *  An edge is cut where it passes from texel to texel; between cuts the running sum is linear, so that the middle of
 *  each piece gives its mean. Eight or sixteen edges are cut at a time, all of them into as many pieces as the one that
 *  needs most: some have no length. This is exact but for the rounding of single precision. */
template <int channels, int size>
class PictureMeans {
 public:
  using Value = typename SumLanes<channels>::Value;

  /** @return false if pixels see too many texels, or a tile next to none: this is no way for them then */
  bool integrate(const PictureCorners<size>& corners, const Texture& texture, Wrap wrap_s, Wrap wrap_t);

  /** Mean colour of each pixel, 0 .. 255, row by row of `size`. */
  const Value* means() const { return means_.data(); }

 private:
  static constexpr int kStride = PictureCorners<size>::kStride, kCount = PictureCorners<size>::kCount;
  using Values = std::array<Value, kCount>;

  bool integrateEdges(const float* xa, const float* ya, const float* xb, const float* yb, int count, Value* integrals);

  PictureWindow<channels> window_;
  std::array<float, kCount> x_, y_, x_turned_, y_turned_;  // of the corners, row by row and column by column
  Values across_, down_;  // integrals along edges to the right, row by row, and downwards, column by column
  std::array<Value, std::size_t(size) * size> means_;
};

}  // namespace aras_visual_servo_sim
