#include "segmentation/edge_weights.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace aras_visual_servo_camera {

namespace {

constexpr int kReach = 2;  // edge pixels lie within this distance of the contour
// Away from the contour a weight that is within three standard deviations of the noise of 0 or 1 counts as that; 0.67
// of the standard deviation is the median of the noise's size.
constexpr double kMedians = 3.0 / 0.67;
constexpr double kMostFaint = 1.0 / 16;  // what is larger may be blur
constexpr int kMargin = 2 * kReach;      // the box of edge pixels, and what their windows look at
constexpr int kBits = 64;                // columns of a word

/** Column c of a row of bits stands in word 1 + c / kBits. */
bool hasBit(const std::uint64_t* row, int c) { return row[1 + c / kBits] >> (c % kBits) & 1; }

void setBits(std::uint64_t* row, int begin, int end) {
  for (int c = begin; c < end;) {
    const int bit = c % kBits, count = std::min(kBits - bit, end - c);
    const std::uint64_t ones = count == kBits ? ~std::uint64_t{0} : (std::uint64_t{1} << count) - 1;
    row[1 + c / kBits] |= ones << bit;
    c += count;
  }
}

/** First column from `begin` on whose bit is kSet; `limit` if there is none before that. */
template <bool kSet>
int findBit(const std::vector<std::uint64_t>& row, int begin, int limit) {
  for (int c = begin; c < limit; c += kBits - c % kBits) {
    const std::uint64_t word = (kSet ? row[1 + c / kBits] : ~row[1 + c / kBits]) >> (c % kBits);
    if (word != 0) return std::min(c + __builtin_ctzll(word), limit);
  }
  return limit;
}

/** The bits that lie k columns before, or after, those of a word. */
template <int k>
std::uint64_t before(const std::uint64_t* word) {
  return word[0] << k | word[-1] >> (kBits - k);
}
template <int k>
std::uint64_t after(const std::uint64_t* word) {
  return word[0] >> k | word[1] << (kBits - k);
}

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
  const std::size_t size = static_cast<std::size_t>(rows_) * words_;
  own_.assign(size, 0);
  others_in_box_ = false;
  for (const Run& run : finder.runs()) {
    const int row = run.v - v0_;
    const int begin = std::max(run.u_begin - u0_, 0), end = std::min(run.u_end - u0_, stride_);
    if (row < 0 || row >= rows_ || begin >= end) continue;
    const bool mine = run.component == chosen;
    if (!mine && !others_in_box_) {
      other_.assign(size, 0);
      others_in_box_ = true;
    }
    setBits(at(mine ? own_ : other_, row), begin, end);
  }
}

// Outside the image the border pixels are repeated, so that an object cut by the border has no edge there.
void EdgeWeights::replicateAtImageBorder(int width, int height) {
  const int first = std::max(-u0_, 0), last = std::min(width - 1 - u0_, stride_ - 1);
  const int top = std::max(-v0_, 0), bottom = std::min(height - 1 - v0_, rows_ - 1);
  for (int row = top; row <= bottom; ++row) {
    std::uint64_t* p = at(own_, row);
    if (hasBit(p, first)) setBits(p, 0, first);
    if (hasBit(p, last)) setBits(p, last + 1, stride_);
  }
  const auto copyRow = [this](int to, int from) { std::copy_n(at(own_, from), words_, at(own_, to)); };
  for (int row = 0; row < top; ++row) copyRow(row, top);
  for (int row = bottom + 1; row < rows_; ++row) copyRow(row, bottom);
}

void EdgeWeights::widen() {
  const std::size_t size = static_cast<std::size_t>(rows_) * words_;
  for (Bits* bits : {&any3_, &all3_, &any5_, &all5_}) bits->resize(size);
  for (int row = 0; row < rows_; ++row) {
    const std::uint64_t* own = at(own_, row);
    for (int i = 1; i < words_ - 1; ++i) {
      const std::uint64_t here = own[i], left = before<1>(own + i), right = after<1>(own + i);
      const std::uint64_t left2 = before<2>(own + i), right2 = after<2>(own + i);
      at(any3_, row)[i] = here | left | right;
      at(all3_, row)[i] = here & left & right;
      at(any5_, row)[i] = here | left | right | left2 | right2;
      at(all5_, row)[i] = here & left & right & left2 & right2;
    }
  }
}

void EdgeWeights::classify(int row) {
  static_assert(kReach == 2, "the windows below are written out");
  for (Bits* bits : {&inside_, &edge_, &next_}) bits->assign(words_, 0);
  for (int i = 1; i < words_ - 1; ++i) {
    const auto of = [&](const Bits& bits, int off) { return at(bits, row + off)[i]; };
    const std::uint64_t own = of(any3_, -1) | of(any3_, 0) | of(any3_, 1);
    const std::uint64_t any = of(any5_, -2) | of(any5_, -1) | of(any5_, 0) | of(any5_, 1) | of(any5_, 2);
    inside_[i] = of(all5_, -2) & of(all5_, -1) & of(all5_, 0) & of(all5_, 1) & of(all5_, 2);
    edge_[i] = any & ~inside_[i];
    next_[i] = own & ~(of(all3_, -1) & of(all3_, 0) & of(all3_, 1));
    if (!others_in_box_) continue;
    const auto touches = [&](int off) {
      const std::uint64_t* other = at(other_, row + off) + i;
      return *other | before<1>(other) | after<1>(other);
    };
    edge_[i] &=
        ~(of(other_, 0) | ((touches(-1) | touches(0) | touches(1)) & ~own));  // of another, or of its edge alone
  }
}

void EdgeWeights::emitRow(const std::array<const std::uint8_t*, 3>& rows, int v, const double* weight_of_grey,
                          ObjectMask* mask) {
  classify(v - v0_);
  // Columns outside the image carry replicated pixels: clip to the image through mask->width_px.
  const int first = std::max(-u0_, 0), limit = std::min(mask->width_px - u0_, stride_);
  for (int c = findBit<true>(inside_, first, limit); c < limit;) {
    const int end = findBit<false>(inside_, c, limit);
    mask->spans.emplace_back() = {v, c + u0_, end + u0_};
    c = findBit<true>(inside_, end, limit);
  }
  for (int c = findBit<true>(edge_, first, limit); c < limit; c = findBit<true>(edge_, c + 1, limit)) {
    const int u = c + u0_;
    const double weight = weight_of_grey[rows[1][u]];
    const bool away = !hasBit(next_.data(), c);
    if (away && (weight == 0.0 || weight == 1.0)) {
      ++sure_;
    } else if (away) {
      away_.push_back(mask->edge.size());
      faint_.push_back(std::min(std::abs(weight), std::abs(1.0 - weight)));
    }
    if (weight == 0.0) continue;
    const PixelPoint part = coveredPart(rows, u, mask->width_px, weight_of_grey, weight);
    mask->edge.emplace_back() = {v, u, weight, part.u, part.v};
  }
}

void EdgeWeights::forgetNoiseAwayFromContour(ObjectMask* mask) {
  if (faint_.empty()) return;
  double median = 0.0;
  const std::size_t middle = (sure_ + faint_.size()) / 2;
  if (middle >= sure_) {
    const auto found = faint_.begin() + static_cast<std::ptrdiff_t>(middle - sure_);
    std::nth_element(faint_.begin(), found, faint_.end());
    median = *found;
  }
  const double noise = std::min(kMedians * median, kMostFaint);
  bool emptied = false;
  for (const std::size_t k : away_) {
    EdgePixel& pixel = mask->edge[k];
    if (pixel.weight <= noise) {
      pixel = {pixel.v, pixel.u, 0.0};
      emptied = true;
    }
    if (pixel.weight >= 1.0 - noise) pixel = {pixel.v, pixel.u, 1.0};
  }
  if (!emptied) return;
  const auto empty = [](const EdgePixel& pixel) { return pixel.weight == 0.0; };
  mask->edge.erase(std::remove_if(mask->edge.begin(), mask->edge.end(), empty), mask->edge.end());
}

GreyLevels EdgeWeights::besideContour(const std::uint8_t* grey, std::size_t step, int width, int height,
                                      GreyLevels levels) {
  std::uint64_t inside = 0, outside = 0, inside_sum = 0, outside_sum = 0;
  const int first = std::max(-u0_, 0), limit = std::min(width - u0_, stride_),
            v_end = std::min(v0_ + rows_ - kReach, height);
  for (int v = std::max(v0_ + kReach, 0); v < v_end; ++v) {
    classify(v - v0_);
    const std::uint8_t* row = grey + v * step;
    const std::uint64_t* own = at(own_, v - v0_);
    for (int c = findBit<true>(inside_, first, limit); c < limit; c = findBit<true>(inside_, c + 1, limit)) {
      inside_sum += row[c + u0_];
      ++inside;
    }
    for (int c = findBit<true>(edge_, first, limit); c < limit; c = findBit<true>(edge_, c + 1, limit)) {
      if (hasBit(own, c) || hasBit(next_.data(), c)) continue;
      outside_sum += row[c + u0_];
      ++outside;
    }
  }
  GreyLevels beside = levels;
  if (levels.object_estimated && inside > 0)
    beside.object = static_cast<double>(inside_sum) / static_cast<double>(inside);
  if (levels.background_estimated && outside > 0)
    beside.background = static_cast<double>(outside_sum) / static_cast<double>(outside);
  const bool dark = levels.object < levels.background;  // a contour that follows something else has no levels
  return (beside.object < beside.background) == dark && beside.object != beside.background ? beside : levels;
}

void EdgeWeights::process(const std::uint8_t* grey, std::size_t step, int width, int height,
                          const ComponentFinder& finder, int chosen, GreyLevels levels, ObjectMask* mask) {
  const Component& box = finder.components()[chosen];
  u0_ = box.u_min - kMargin;
  v0_ = box.v_min - kMargin;
  stride_ = box.u_max - box.u_min + 1 + 2 * kMargin;
  rows_ = box.v_max - box.v_min + 1 + 2 * kMargin;
  words_ = (stride_ + kBits - 1) / kBits + 2;
  paint(finder, chosen);
  replicateAtImageBorder(width, height);
  widen();
  if (levels.object_estimated || levels.background_estimated) levels = besideContour(grey, step, width, height, levels);
  mask->grey_step = 1.0 / std::abs(levels.background - levels.object);

  double weight_of_grey[256];
  for (int g = 0; g < 256; ++g) weight_of_grey[g] = (levels.background - g) / (levels.background - levels.object);
  away_.clear();
  faint_.clear();
  sure_ = 0;
  const int v_end = std::min(v0_ + rows_ - kReach, height);
  for (int v = std::max(v0_ + kReach, 0); v < v_end; ++v) {
    const auto row = [&](int of) { return grey + std::clamp(of, 0, height - 1) * step; };
    emitRow({row(v - 1), row(v), row(v + 1)}, v, weight_of_grey, mask);
  }
  forgetNoiseAwayFromContour(mask);
}

// The smaller part of the pixel, of area `part`, lies at the corner to which the gradient points (or, if it is the part
// that is not covered, at the opposite one). X and Y are measured from that corner, X along the steeper axis; the line
// is X + slope Y = p, slope 0 to 1. It cuts off a triangle, or a trapezoid over the whole of 0 < Y < 1.
PixelPoint centroidOfCoveredPart(double weight, double gradient_u, double gradient_v) {
  const double across = std::abs(gradient_u), along = std::abs(gradient_v);
  const double steep = std::max(across, along);
  if (!(weight > 0.0 && weight < 1.0 && steep > 0.0)) return {};
  const double slope = std::min(across, along) / steep, part = std::min(weight, 1.0 - weight);
  double X, Y;
  if (part < 0.5 * slope) {
    const double p = std::sqrt(2.0 * slope * part);
    X = p / 3.0;
    Y = X / slope;
  } else {
    X = 0.5 * part + slope * slope / (24.0 * part);
    Y = 0.5 - slope / (12.0 * part);
  }
  // The centroid of both parts together is the centre of the pixel.
  const double scale = part / weight, to_steep = scale * (0.5 - X), to_other = scale * (0.5 - Y);
  return {std::copysign(across >= along ? to_steep : to_other, gradient_u),
          std::copysign(across >= along ? to_other : to_steep, gradient_v)};
}

}  // namespace aras_visual_servo_camera
