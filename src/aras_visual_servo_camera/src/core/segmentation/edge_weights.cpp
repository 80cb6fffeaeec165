#include "segmentation/edge_weights.hpp"

#include <algorithm>
#include <cstring>

namespace aras_visual_servo_camera {
namespace {

constexpr int kReach = 2;            // edge pixels lie within this distance of the contour
constexpr int kMargin = 2 * kReach;  // the box of edge pixels, and what their windows look at

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

void EdgeWeights::emitRow(const std::uint8_t* grey_row, int v, const double* weight_of_grey, ObjectMask* mask) const {
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
      const double weight = weight_of_grey[grey_row[c + u0_]];
      if (weight > 0.0 && !belongsToAnother(row, c)) mask->edge.push_back({v, c + u0_, weight});
    }
  }
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
  for (int g = 0; g < 256; ++g)
    weight_of_grey[g] = std::clamp((levels.background - g) / (levels.background - levels.object), 0.0, 1.0);
  const int v_end = std::min(v0_ + rows_ - kReach, height);
  for (int v = std::max(v0_ + kReach, 0); v < v_end; ++v) emitRow(grey + v * step, v, weight_of_grey, mask);
}

}  // namespace aras_visual_servo_camera
