#include "segmentation/edge_weights.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>

#include "segmentation/covered_part.hpp"

namespace aras_visual_servo_camera {
namespace {

constexpr int kReach = 2;  // edge pixels lie within this distance of the contour
// Away from the contour a weight that is within three standard deviations of the noise of 0 or 1 counts as that; 0.67
// of the standard deviation is the median of the noise's size.
constexpr double kMedians = 3.0 / 0.67;
constexpr double kMostFaint = 1.0 / 16;  // what is larger may be blur
constexpr int kMargin = 2 * kReach;      // the box of edge pixels, and what their windows look at

// Where the covered part of pixel u lies: across the gradient of the weights around it, by Scharr's operator.
PixelPoint coveredPart(const std::array<const std::uint8_t*, 3>& rows, int u, int width, const double* weight_of_grey,
                       double weight) {
  if (!(weight > 0.0 && weight < 1.0)) return {};
  const int left = std::max(u - 1, 0), right = std::min(u + 1, width - 1);
  const auto at = [&](int row, int column) { return weight_of_grey[rows[row][column]]; };
  const double down_left = at(2, left) - at(0, right), down_right = at(2, right) - at(0, left);
  return centroidOfCoveredPart(weight, 10.0 * (at(1, right) - at(1, left)) + 3.0 * (down_right - down_left),
                               10.0 * (at(2, u) - at(0, u)) + 3.0 * (down_right + down_left));
}

}  // namespace

void EdgeWeights::paint(const ComponentFinder& finder, int chosen) {
  const std::size_t size = static_cast<std::size_t>(rows_) * stride_;
  own_.assign(size, 0);
  other_.assign(size, 0);
  others_in_box_ = false;
  for (const Run& run : finder.runs()) {
    const int row = run.v - v0_;
    const int begin = std::max(run.u_begin - u0_, 0), end = std::min(run.u_end - u0_, stride_);
    if (row < 0 || row >= rows_ || begin >= end) continue;
    const bool mine = run.component == chosen;
    std::memset(at(mine ? own_ : other_, row) + begin, 1, end - begin);
    others_in_box_ |= !mine;
  }
}

// Outside the image the border pixels are repeated, so that an object cut by the border has no edge there.
void EdgeWeights::replicateAtImageBorder(int width, int height) {
  const int first = std::max(-u0_, 0), last = std::min(width - 1 - u0_, stride_ - 1);
  const int top = std::max(-v0_, 0), bottom = std::min(height - 1 - v0_, rows_ - 1);
  for (int row = top; row <= bottom; ++row) {
    std::uint8_t* p = at(own_, row);
    std::fill(p, p + first, p[first]);
    std::fill(p + last + 1, p + stride_, p[last]);
  }
  for (int row = 0; row < top; ++row) std::memcpy(at(own_, row), at(own_, top), stride_);
  for (int row = bottom + 1; row < rows_; ++row) std::memcpy(at(own_, row), at(own_, bottom), stride_);
}

// Windows of 5 x 5, first along rows, then along columns; plain loops over bytes that the compiler vectorises.
void EdgeWeights::growAndShrink() {
  const std::size_t size = static_cast<std::size_t>(rows_) * stride_;
  row_or_.assign(size, 0);
  row_and_.assign(size, 0);
  inside_.assign(size, 0);
  edge_.assign(size, 0);
  static_assert(kReach == 2, "the windows below are written out");
  for (int row = 0; row < rows_; ++row) {
    const std::uint8_t* p = at(own_, row) + kReach;
    std::uint8_t* any = at(row_or_, row) + kReach;
    std::uint8_t* all = at(row_and_, row) + kReach;
    for (int k = 0; k < stride_ - 2 * kReach; ++k) {
      any[k] = p[k - 2] | p[k - 1] | p[k] | p[k + 1] | p[k + 2];
      all[k] = p[k - 2] & p[k - 1] & p[k] & p[k + 1] & p[k + 2];
    }
  }
  for (int row = kReach; row < rows_ - kReach; ++row) {
    const std::uint8_t *a = at(row_or_, row), *b = at(row_and_, row);
    std::uint8_t *inside = at(inside_, row), *edge = at(edge_, row);
    const int s = stride_;
    for (int k = 0; k < s; ++k) {
      inside[k] = b[k - 2 * s] & b[k - s] & b[k] & b[k + s] & b[k + 2 * s];
      edge[k] = (a[k - 2 * s] | a[k - s] | a[k] | a[k + s] | a[k + 2 * s]) & ~inside[k] & 1;
    }
  }
}

// A pixel of another object, or of its edge alone.
bool EdgeWeights::belongsToAnother(int row, int col) const {
  if (!others_in_box_) return false;
  if (at(other_, row)[col]) return true;
  bool touches_own = false, touches_other = false;
  for (int r = row - 1; r <= row + 1; ++r) {
    for (int c = col - 1; c <= col + 1; ++c) {
      touches_own |= at(own_, r)[c] != 0;
      touches_other |= at(other_, r)[c] != 0;
    }
  }
  return touches_other && !touches_own;
}

bool EdgeWeights::isNextToContour(int row, int col) const {
  int own = 0;
  for (int r = row - 1; r <= row + 1; ++r) {
    const std::uint8_t* p = at(own_, r) + col;
    own += p[-1] + p[0] + p[1];
  }
  return own != 0 && own != 9;
}

void EdgeWeights::emitRow(const std::array<const std::uint8_t*, 3>& rows, int v, const double* weight_of_grey,
                          ObjectMask* mask) {
  const int row = v - v0_;
  const auto find = [this](const std::uint8_t* p, int begin, int value) {
    const void* found = begin < stride_ ? std::memchr(p + begin, value, stride_ - begin) : nullptr;
    return found == nullptr ? stride_ : static_cast<int>(static_cast<const std::uint8_t*>(found) - p);
  };
  // Columns outside the image carry replicated pixels: clip to the image through mask->width_px.
  const int first = std::max(-u0_, 0), limit = std::min(mask->width_px - u0_, stride_);
  const std::uint8_t* inside = at(inside_, row);
  for (int c = find(inside, first, 1); c < limit;) {
    const int end = std::min(find(inside, c, 0), limit);
    mask->spans.push_back({v, c + u0_, end + u0_});
    c = find(inside, end, 1);
  }
  const std::uint8_t* edge = at(edge_, row);
  for (int c = find(edge, first, 1); c < limit; c = find(edge, c, 1)) {
    for (; c < limit && edge[c]; ++c) {
      const int u = c + u0_;
      const double weight = weight_of_grey[rows[1][u]];
      if (belongsToAnother(row, c)) continue;
      if (!isNextToContour(row, c)) {
        away_.push_back(mask->edge.size());
        faint_.push_back(std::min(std::abs(weight), std::abs(1.0 - weight)));
      }
      const PixelPoint part = coveredPart(rows, u, mask->width_px, weight_of_grey, weight);
      mask->edge.push_back({v, u, weight, part.u, part.v});
    }
  }
}

void EdgeWeights::forgetNoiseAwayFromContour(ObjectMask* mask) {
  if (faint_.empty()) return;
  const auto middle = faint_.begin() + static_cast<std::ptrdiff_t>(faint_.size() / 2);
  std::nth_element(faint_.begin(), middle, faint_.end());
  const double noise = std::min(kMedians * *middle, kMostFaint);
  for (const std::size_t k : away_) {
    EdgePixel& pixel = mask->edge[k];
    if (pixel.weight <= noise) pixel = {pixel.v, pixel.u, 0.0};
    if (pixel.weight >= 1.0 - noise) pixel = {pixel.v, pixel.u, 1.0};
  }
  const auto empty = [](const EdgePixel& pixel) { return pixel.weight == 0.0; };
  mask->edge.erase(std::remove_if(mask->edge.begin(), mask->edge.end(), empty), mask->edge.end());
}

void EdgeWeights::process(const std::uint8_t* grey, std::size_t step, int width, int height,
                          const ComponentFinder& finder, int chosen, const GreyLevels& levels, ObjectMask* mask) {
  const Component& box = finder.components()[chosen];
  u0_ = box.u_min - kMargin;
  v0_ = box.v_min - kMargin;
  stride_ = box.u_max - box.u_min + 1 + 2 * kMargin;
  rows_ = box.v_max - box.v_min + 1 + 2 * kMargin;
  paint(finder, chosen);
  replicateAtImageBorder(width, height);
  growAndShrink();

  double weight_of_grey[256];
  for (int g = 0; g < 256; ++g) weight_of_grey[g] = (levels.background - g) / (levels.background - levels.object);
  away_.clear();
  faint_.clear();
  const int v_end = std::min(v0_ + rows_ - kReach, height);
  for (int v = std::max(v0_ + kReach, 0); v < v_end; ++v) {
    const auto row = [&](int of) { return grey + std::clamp(of, 0, height - 1) * step; };
    emitRow({row(v - 1), row(v), row(v + 1)}, v, weight_of_grey, mask);
  }
  forgetNoiseAwayFromContour(mask);
}

}  // namespace aras_visual_servo_camera
