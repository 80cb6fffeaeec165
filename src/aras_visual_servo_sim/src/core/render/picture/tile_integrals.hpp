#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>

#include "aras_visual_servo_sim/image/texture.hpp"
#include "picture_window.hpp"

namespace aras_visual_servo_sim {

/** Integrals of a level's running sums along straight edges, inside the picture, in single precision.
 *
 *  Coordinates count from an origin texel, and each row's sums from that column: both stay small, and what is left out
 *  of a row is the same for all edges of a closed loop. */
template <int channels>
class TileIntegrals {
 public:
  using Lanes = SumLanes<channels>;
  using Value = typename Lanes::Value;

  static constexpr int kMostEdges = 20;  ///< of one call: a row of a tile, in whole vectors
  using Coordinates = std::array<float, kMostEdges>;
  using Values = std::array<Value, kMostEdges>;

  /** @param width  of the texture [texels] @param column, row  of the origin, in the level */
  TileIntegrals(const Texture::Level& level, int width, int column, int row)
      : stride_(std::size_t(width + 1) * channels),
        origin_(level.sums.data() + row * stride_ + column * channels),
        last_row_(level.rows - 1 - row) {}

  /** Integrals over dy along `count` edges from (xa, ya) to (xb, yb); y in rows of the level.
   *  @pre coordinates >= 0, inside the level; those beyond count are anything finite */
  void along(const float* xa, const float* ya, const float* xb, const float* yb, int count, Values& integrals) {
    for (int i = 0; i < kMostEdges; ++i) {  // all at once: this loop becomes vector instructions
      const bool downwards = ya[i] <= yb[i];
      sign_[i] = downwards ? 1.0f : -1.0f;
      x0_[i] = downwards ? xa[i] : xb[i];
      x1_[i] = downwards ? xb[i] : xa[i];
      y0_[i] = downwards ? ya[i] : yb[i];
      y1_[i] = downwards ? yb[i] : ya[i];
      const float width = x1_[i] - x0_[i], height = y1_[i] - y0_[i];
      slope_[i] = width / height;
      rise_[i] = height / std::abs(width);
      column_[i] = static_cast<int>(x0_[i]);
      last_column_[i] = static_cast<int>(x1_[i]);
      row_[i] = static_cast<int>(y0_[i]);
      crossed_[i] = static_cast<int>(y1_[i]) - row_[i];
    }
    for (int i = 0; i < count; ++i) integrals[i] = sign_[i] * downwards(i);
  }

 private:
  static constexpr int kMostPieces = 4;  // of an edge within one row: exact below, sampled above

  Value downwards(int i) const {
    Value sum{};
    int column = column_[i], row = row_[i];
    float x = x0_[i], y = y0_[i];
    const std::int32_t* sums = origin_ + row * stride_;
    for (const int end_row = std::min(row + crossed_[i], last_row_); row < end_row; sums += stride_) {
      const float end = static_cast<float>(++row);
      const float x_end = x0_[i] + (end - y0_[i]) * slope_[i];
      const int end_column = static_cast<int>(x_end);
      addRow(sums, column, x, end_column, x_end, end - y, rise_[i], sum);
      column = end_column;
      x = x_end;
      y = end;
    }
    addRow(sums, column, x, last_column_[i], x1_[i], y1_[i] - y, rise_[i], sum);
    return sum;
  }

  /** Adds height times the mean of a row's sums over x0 .. x1, which lie in these columns; linear between texel edges,
   *  so the middle of each piece gives its mean. @param rise  |dy / dx| */
  void addRow(const std::int32_t* sums, int column, float x0, int last, float x1, float height, float rise,
              Value& sum) const {
    const auto base = Lanes::load(sums);
    const auto add = [&](int at, float part, float weight) {
      const auto here = Lanes::load(sums + at * channels), next = Lanes::load(sums + (at + 1) * channels);
      sum += weight * (Lanes::real(here - base) + part * Lanes::real(next - here));
    };
    if (column == last) return add(column, 0.5f * (x0 + x1) - static_cast<float>(column), height);
    if (column > last) {
      std::swap(column, last);
      std::swap(x0, x1);
    }
    if (last - column < kMostPieces) {
      for (; column < last; ++column) {
        const float edge = static_cast<float>(column + 1);
        add(column, 0.5f * (x0 + edge) - (edge - 1.0f), rise * (edge - x0));
        x0 = edge;
      }
      return add(column, 0.5f * (x0 + x1) - static_cast<float>(column), rise * (x1 - x0));
    }
    const float step = (x1 - x0) / kMostPieces;
    for (int k = 0; k < kMostPieces; ++k) {
      const float x = x0 + (static_cast<float>(k) + 0.5f) * step;
      const int at = static_cast<int>(x);
      add(at, x - static_cast<float>(at), height / kMostPieces);
    }
  }

  std::size_t stride_;
  const std::int32_t* origin_;
  int last_row_;
  Coordinates sign_, x0_, y0_, x1_, y1_, slope_, rise_;
  std::array<int, kMostEdges> column_, last_column_, row_, crossed_;
};

// At a picture's border: in double precision, knowing where there is nothing.

/** The running sums of one row of a level; nothing is seen left and right of them. */
template <int channels>
class BorderRow {
 public:
  BorderRow(const Texture::Level& level, int width, int row)
      : sums_(level.sums.data() + std::size_t(row) * (width + 1) * channels), width_(width) {}

  /** Adds dy times the mean of the sums over x0 .. x1, and of min(max(x, 0), width). */
  void add(double x0, double x1, double dy, double* integral) const {
    if (x0 > x1) std::swap(x0, x1);
    const int first = floor(x0), last = floor(x1);
    // Linear between texel edges, so the middle of each piece gives its mean.
    if (first == last) {
      addAt(0.5 * (x0 + x1), dy, integral);
    } else if (last - first < kMostPieces) {
      const double share = dy / (x1 - x0);
      double left = x0;
      for (int edge = first + 1; edge <= last; ++edge) {
        addAt(0.5 * (left + edge), share * (edge - left), integral);
        left = edge;
      }
      addAt(0.5 * (left + x1), share * (x1 - left), integral);
    } else {
      const double step = (x1 - x0) / kMostPieces;
      for (int k = 0; k < kMostPieces; ++k) addAt(x0 + (k + 0.5) * step, dy / kMostPieces, integral);
    }
  }

 private:
  static constexpr int kMostPieces = 4;  // of an edge within one row: exact below, sampled above

  static int floor(double x) {
    const int i = static_cast<int>(x);
    return x < i ? i - 1 : i;
  }
  void addAt(double x, double weight, double* integral) const {
    x = std::clamp(x, 0.0, double(width_));
    integral[channels] += weight * x;
    const int i = std::min(static_cast<int>(x), width_ - 1);
    const double part = x - i;
    const std::int32_t* sum = sums_ + i * channels;
    for (int c = 0; c < channels; ++c) integral[c] += weight * (sum[c] + part * (sum[c + channels] - sum[c]));
  }

  const std::int32_t* sums_;
  int width_;
};

/** Integral of the running sum over dy along a straight edge; y in rows of the level, and nothing beyond its rows. */
template <int channels>
void integrateEdge(const Texture::Level& level, int width, const Eigen::Vector2d& a, const Eigen::Vector2d& b,
                   double* integral) {
  std::fill(integral, integral + channels + 1, 0.0);
  const bool downwards = a.y() < b.y();
  const Eigen::Vector2d &from = downwards ? a : b, &to = downwards ? b : a;
  const double sign = downwards ? 1.0 : -1.0;
  const double top = std::max(from.y(), 0.0), bottom = std::min(to.y(), double(level.rows));
  if (!(bottom > top)) return;
  const double slope = (to.x() - from.x()) / (to.y() - from.y());
  double y0 = top, x0 = from.x() + (top - from.y()) * slope;
  for (int row = std::min(static_cast<int>(top), level.rows - 1); y0 < bottom; ++row) {
    const double y1 = row + 1 >= level.rows ? bottom : std::min(bottom, row + 1.0);
    const double x1 = from.x() + (y1 - from.y()) * slope;
    BorderRow<channels>(level, width, row).add(x0, x1, sign * (y1 - y0), integral);
    y0 = y1;
    x0 = x1;
  }
}

}  // namespace aras_visual_servo_sim
