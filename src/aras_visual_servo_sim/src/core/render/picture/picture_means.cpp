#include "picture_means.hpp"

#include <algorithm>

#include "aras_visual_servo_sim/config/wide.hpp"
#include "render/pixels/eight.hpp"

namespace aras_visual_servo_sim {
namespace {

// Eight edges at a time, as vectors: choices in place of branches. Without AVX2 they are two vectors of four.
constexpr int kLanes = 8;
#define ARAS_INLINE inline __attribute__((always_inline)) void

/** Straight edges among texels, cut where they pass from one to the next. `size` edges (8 or 16) at a time. */
template <int size>
struct EdgePieces {
  static constexpr int kMostCuts = 5;  ///< through columns, and as many through rows
  static constexpr int kMostPieces = 2 * kMostCuts + 1;

  int count = 0;                                      ///< pieces of each edge, some of no length
  alignas(32) std::int32_t entry[kMostPieces][size];  ///< row * stride + column of the texel about a piece
  alignas(32) float part[kMostPieces][size];          ///< share of the texel's width left of the piece's middle
  alignas(32) float height[kMostPieces][size];        ///< that the piece spans, signed
};

/** The coordinates of edges along one axis. */
struct Axis {
  EightFloats from, length;
  EightInts first, up, gap;  ///< texel of the start; -1 where the edge goes up, else 0; borders that it crosses

  ARAS_INLINE set(const float* a, const float* b) {
    const EightFloats to = eightAt(b).values;
    from = eightAt(a).values;
    length = to - from;
    first = __builtin_convertvector(from, EightInts);
    gap = __builtin_convertvector(to, EightInts) - first;
    up = gap > 0;
    gap = up ? gap : -gap;
  }

  /** Share of the way to the k-th border, 1 where there is none. */
  ARAS_INLINE crossing(std::int32_t k, EightFloats& share) const {
    const EightInts border = first + (up ? EightInts{} + (k + 1) : EightInts{} - k);
    share = (__builtin_convertvector(border, EightFloats) - from) / length;
    share = share > 0.0f ? share : EightFloats{};
    share = ((share < 1.0f) & (gap > k)) ? share : EightFloats{} + 1.0f;
  }
};

/** @return the most borders that an edge crosses */
template <int size>
inline __attribute__((always_inline)) int mostCrossed(const float* a, const float* b) {
  EightInts most{};
  for (int i = 0; i < size; i += kLanes) {
    Axis axis;
    axis.set(a + i, b + i);
    most = axis.gap > most ? axis.gap : most;
  }
  std::int32_t result = 0;
  for (int i = 0; i < kLanes; ++i) result = std::max(result, most[i]);
  return result;
}

template <int size>
ARAS_INLINE cutEdges(const float* xa, const float* ya, const float* xb, const float* yb, std::int32_t stride,
                     int columns, int rows, EdgePieces<size>& pieces) {
  for (int i = 0; i < size; i += kLanes) {
    Axis x, y;
    x.set(xa + i, xb + i);
    y.set(ya + i, yb + i);
    EightFloats cuts[EdgePieces<size>::kMostPieces];
    for (int k = 0; k < columns; ++k) x.crossing(k, cuts[k]);
    for (int k = 0; k < rows; ++k) {  // each is sorted in
      EightFloats more;
      y.crossing(k, more);
      for (int m = 0; m < columns + k; ++m) {
        const EightFloats here = cuts[m];
        cuts[m] = here < more ? here : more;
        more = here < more ? more : here;
      }
      cuts[columns + k] = more;
    }
    cuts[columns + rows] = EightFloats{} + 1.0f;
    EightFloats begin{};
    for (int m = 0; m <= columns + rows; ++m) {
      const EightFloats end = cuts[m], middle = 0.5f * (begin + end);
      const EightFloats px = x.from + middle * x.length, py = y.from + middle * y.length;
      const EightInts column = __builtin_convertvector(px, EightInts), row = __builtin_convertvector(py, EightInts);
      const EightInts entry = row * stride + column;
      const EightFloats part = px - __builtin_convertvector(column, EightFloats), height = (end - begin) * y.length;
      eightAt(&pieces.entry[m][i]).values = entry;
      eightAt(&pieces.part[m][i]).values = part;
      eightAt(&pieces.height[m][i]).values = height;
      begin = end;
    }
  }
  pieces.count = columns + rows + 1;
}
#undef ARAS_INLINE

ARAS_WIDE int mostCrossed8(const float* a, const float* b) { return mostCrossed<8>(a, b); }
ARAS_WIDE int mostCrossed16(const float* a, const float* b) { return mostCrossed<16>(a, b); }
ARAS_WIDE void cut8(const float* xa, const float* ya, const float* xb, const float* yb, std::int32_t stride,
                    int columns, int rows, EdgePieces<8>& pieces) {
  cutEdges<8>(xa, ya, xb, yb, stride, columns, rows, pieces);
}
ARAS_WIDE void cut16(const float* xa, const float* ya, const float* xb, const float* yb, std::int32_t stride,
                     int columns, int rows, EdgePieces<16>& pieces) {
  cutEdges<16>(xa, ya, xb, yb, stride, columns, rows, pieces);
}

/** Cuts edges from (xa, ya) to (xb, yb). @pre no coordinate is negative @return false if kMostCuts are too few */
template <int size>
bool cut(const float* xa, const float* ya, const float* xb, const float* yb, std::int32_t stride,
         EdgePieces<size>& pieces) {
  const auto most = size == 8 ? mostCrossed8 : mostCrossed16;
  const int columns = most(xa, xb), rows = most(ya, yb);
  if (std::max(columns, rows) > EdgePieces<size>::kMostCuts) return false;
  if constexpr (size == 8) {
    cut8(xa, ya, xb, yb, stride, columns, rows, pieces);
  } else {
    cut16(xa, ya, xb, yb, stride, columns, rows, pieces);
  }
  return true;
}

/** A row of corners, m = first + i * step. */
template <int count>
inline __attribute__((always_inline)) void divideRow(const double* first, const double* step, double* s, double* t) {
  for (int i = 0; i < count; ++i) {
    const double scale = 1.0 / (first[2] + double(i) * step[2]);
    s[i] = (first[0] + double(i) * step[0]) * scale;
    t[i] = (first[1] + double(i) * step[1]) * scale;
  }
}
ARAS_WIDE void divide9(const double* first, const double* step, double* s, double* t) {
  divideRow<9>(first, step, s, t);
}
ARAS_WIDE void divide17(const double* first, const double* step, double* s, double* t) {
  divideRow<17>(first, step, s, t);
}

}  // namespace

Eigen::Matrix3d raysOfPixels(const CameraModel& camera) {
  Eigen::Matrix3d rays;
  rays << 1.0 / camera.fx(), 0.0, -camera.cx() / camera.fx(), 0.0, 1.0 / camera.fy(), -camera.cy() / camera.fy(), 0.0,
      0.0, 1.0;
  return rays;
}

template <int size>
bool PictureCorners<size>::project(const CameraModel& camera, const Eigen::Matrix3d& T,
                                   const Eigen::Matrix3d& pixels_to_picture, const PixelBox& tile, double least) {
  columns_ = tile.u1 - tile.u0;
  rows_ = tile.v1 - tile.v0;
  const bool straight = camera.lens() == CameraModel::Lens::kNone;
  const Eigen::Vector3d step = pixels_to_picture.col(0);
  for (int j = 0; j <= rows_; ++j) {
    double *s = &s_[j * kStride], *t = &t_[j * kStride];
    if (straight) {
      const Eigen::Vector3d first = pixels_to_picture * Eigen::Vector3d(tile.u0 - 0.5, tile.v0 + j - 0.5, 1.0);
      // Linear: what holds for the ends holds between them.
      if (!(first.z() > least && first.z() + double(columns_) * step.z() > least)) return false;
      (size == 8 ? divide9 : divide17)(first.data(), step.data(), s, t);
    } else {
      const Eigen::Vector3d* ray =
          camera.cornerRays().data() + std::size_t(tile.v0 + j) * (camera.width() + 1) + tile.u0;
      for (int i = 0; i <= columns_; ++i, ++ray) {
        const Eigen::Vector3d m = T * *ray;
        if (!(m.z() > least)) return false;
        s[i] = m.x() * (1.0 / m.z());
        t[i] = m.y() * (1.0 / m.z());
      }
    }
    std::fill(s + columns_, s + kStride, s[columns_]);
    std::fill(t + columns_, t + kStride, t[columns_]);
  }
  for (int j = rows_ + 1; j < kStride; ++j) {
    std::copy_n(&s_[rows_ * kStride], kStride, &s_[j * kStride]);
    std::copy_n(&t_[rows_ * kStride], kStride, &t_[j * kStride]);
  }
  measure(straight);
  return true;
}

/** Sets low_, high_ and longest_. @param straight  squares become convex, and smaller from one side to the other: the
 *  first and last ones tell all */
template <int size>
void PictureCorners<size>::measure(bool straight) {
  const int step_u = straight ? columns_ : 1, step_v = straight ? rows_ : 1;
  low_ = high_ = at(0, 0).array();
  longest_.setOnes();
  for (int j = 0; j <= rows_; j += step_v) {
    for (int i = 0; i <= columns_; i += step_u) {
      const Eigen::Array2d corner = at(i, j).array();
      low_ = low_.min(corner);
      high_ = high_.max(corner);
      longest_ = longest_.max((corner - at(i > 0 ? i - 1 : i + 1, j).array()).abs())
                     .max((corner - at(i, j > 0 ? j - 1 : j + 1).array()).abs());
    }
  }
}

template class PictureCorners<8>;
template class PictureCorners<16>;

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
  if (!cut(xa, ya, xb, yb, window_.stride(), pieces)) return false;
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
