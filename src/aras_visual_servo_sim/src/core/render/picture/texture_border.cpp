// The part of TextureSampler that is for tiles at a picture's border: in double precision, knowing where there is
// nothing.
#include <algorithm>
#include <cmath>

#include "render/view/held.hpp"
#include "texture_sampler.hpp"

namespace aras_visual_servo_sim {
namespace {

constexpr int kMostPieces = 4;  // of an edge within one row: exact below, sampled above

/** The running sums of one row of a level; nothing is seen left and right of them. */
template <int channels>
class Row {
 public:
  Row(const Texture::Level& level, int width, int row)
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
    Row<channels>(level, width, row).add(x0, x1, sign * (y1 - y0), integral);
    y0 = y1;
    x0 = x1;
  }
}

}  // namespace

/** At the picture's border a pixel gets the mean of the part that sees it. */
template <int channels, typename Value>
void TextureSampler::integrateBorder(const Tile& tile, ImageOf<Value>& out) {
  double merged = 1.0;
  const Texture::Level& level = levelOf(channels, merged);
  const int columns = tile.box.u1 - tile.box.u0, rows = tile.box.v1 - tile.box.v0;
  constexpr double kFarthest = 1e8;  // [texels] so that rows and columns are numbers
  const auto corner = [&](int i, int j) {
    return Eigen::Vector2d(held(corners_.s(i, j), -kFarthest, kFarthest),
                           held(corners_.t(i, j) / merged, -kFarthest, kFarthest));
  };
  for (int j = 0; j <= rows; ++j) {
    for (int i = 0; i <= columns; ++i) {
      const Eigen::Vector2d here = corner(i, j);
      const int at = 4 * (j * kStride + i);
      if (i < columns) integrateEdge<channels>(level, texture_->width(), here, corner(i + 1, j), &across_[at]);
      if (j < rows) integrateEdge<channels>(level, texture_->width(), here, corner(i, j + 1), &down_[at]);
    }
  }
  for (int j = 0; j < rows; ++j) {
    Value* pixel = out.pixel(tile.box.u0, tile.box.v0 + j);
    for (int i = 0; i < columns; ++i, pixel += channels) {
      const int at = 4 * (j * kStride + i), below = at + 4 * kStride, right = at + 4;
      double sum[4];
      for (int c = 0; c <= channels; ++c)
        sum[c] = across_[at + c] + down_[right + c] - across_[below + c] - down_[at + c];
      const Eigen::Vector2d d1 = corner(i + 1, j + 1) - corner(i, j), d2 = corner(i, j + 1) - corner(i + 1, j);
      const double area = 0.5 * (d1.x() * d2.y() - d1.y() * d2.x());
      constexpr double kSliver = 1e-6;  // of a pixel's area: changes no 8-bit value
      if (std::abs(sum[channels]) <= kSliver * std::abs(area)) {
        sampleCenter(tile.box.u0 + i, tile.box.v0 + j, out);
        continue;
      }
      const double scale = 1.0 / (sum[channels] * merged);  // sums cover `merged` rows each, and so does a unit of y
      double mean[3];
      for (int c = 0; c < channels; ++c) mean[c] = sum[c] * scale;
      write(mean, pixel, out.encoding);
    }
  }
}

template void TextureSampler::integrateBorder<1>(const Tile& tile, Image& out);
template void TextureSampler::integrateBorder<3>(const Tile& tile, Image& out);
template void TextureSampler::integrateBorder<1>(const Tile& tile, FineImage& out);
template void TextureSampler::integrateBorder<3>(const Tile& tile, FineImage& out);

}  // namespace aras_visual_servo_sim
