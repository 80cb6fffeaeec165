#include "picture_means.hpp"

#include <algorithm>

#include "edge_pieces.hpp"

namespace aras_visual_servo_sim {

template <int channels, int size>
bool PictureMeans<channels, size>::integrate(const PictureCorners<size>& corners, const Texture& texture, Wrap wrap_s,
                                             Wrap wrap_t) {
  constexpr double kMostTexels = EdgePieces<size>::kMostCuts - 1;  // along an edge, which then crosses one border more
  if (!((corners.longest() <= kMostTexels).all())) return false;
  if (!window_.place(texture, wrap_s, wrap_t, corners.low(), corners.high())) return false;
  if (window_.isPlain()) {
    means_.fill(window_.color());
    return true;
  }
  constexpr double kSmall = 0.125;  // [texels] a whole tile: single precision would show
  if (!((corners.high() - corners.low()).maxCoeff() >= kSmall)) return false;
  const double s0 = window_.origin()[0], t0 = window_.origin()[1];
  for (int k = 0; k < kCount; ++k) {
    x_[k] = static_cast<float>(corners.s()[k] - s0);
    y_[k] = static_cast<float>(corners.t()[k] - t0);
  }
  for (int j = 0; j < kStride; ++j) {
    for (int i = 0; i < kStride; ++i) {
      x_turned_[i * kStride + j] = x_[j * kStride + i];
      y_turned_[i * kStride + j] = y_[j * kStride + i];
    }
  }
  const int columns = corners.columns(), rows = corners.rows();
  for (int j = 0; j <= rows; ++j) {
    const int row = j * kStride;
    if (!integrateEdges(&x_[row], &y_[row], &x_[row + 1], &y_[row + 1], columns, &across_[row])) return false;
  }
  for (int i = 0; i <= columns; ++i) {
    const int column = i * kStride;
    if (!integrateEdges(&x_turned_[column], &y_turned_[column], &x_turned_[column + 1], &y_turned_[column + 1], rows,
                        &down_[column])) {
      return false;
    }
  }
  for (int j = 0; j < rows; ++j) {
    const float *x0 = &x_[j * kStride], *x1 = x0 + kStride, *y0 = &y_[j * kStride], *y1 = y0 + kStride;
    float scale[size];
    for (int i = 0; i < size; ++i) {
      scale[i] = 2.0f / ((x1[i + 1] - x0[i]) * (y1[i] - y0[i + 1]) - (y1[i + 1] - y0[i]) * (x1[i] - x0[i + 1]));
    }
    const Value *above = &across_[j * kStride], *below = above + kStride, *left = &down_[j], *right = left + kStride;
    Value* means = &means_[j * size];
    for (int i = 0; i < columns; ++i) {
      means[i] = (above[i] + right[i * kStride] - below[i] - left[i * kStride]) * scale[i];
    }
  }
  return true;
}

/** Of the running sums over dy along edges. @return false if there are too many texels along one */
template <int channels, int size>
bool PictureMeans<channels, size>::integrateEdges(const float* xa, const float* ya, const float* xb, const float* yb,
                                                  int count, Value* integrals) {
  EdgePieces<size> pieces;
  if (!pieces.cut(xa, ya, xb, yb, window_.stride())) return false;
  const Value* sums = window_.sums();
  for (int i = 0; i < count; ++i) {
    Value sum{};
    for (int k = 0; k < pieces.count; ++k) {
      const Value *here = sums + pieces.entry[k][i], *next = here + 1;
      sum += pieces.height[k][i] * (*here + pieces.part[k][i] * (*next - *here));
    }
    integrals[i] = sum;
  }
  return true;
}

template class PictureMeans<1, 16>;
template class PictureMeans<3, 8>;
template class PictureMeans<3, 16>;

}  // namespace aras_visual_servo_sim
