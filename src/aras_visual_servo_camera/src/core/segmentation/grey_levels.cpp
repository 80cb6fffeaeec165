#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <utility>

#include "aras_visual_servo_camera/segmentation/segmentation.hpp"

namespace aras_visual_servo_camera {
namespace {

using Histogram = std::array<int, 256>;

constexpr double kMadToSigma = 1.4826;  // of a normal distribution
constexpr int kSmoothing = 4;           // half width of the triangle that smooths the histogram, levels
constexpr double kMinHalfWidth = 2.0;   // of the window around a level: rounding and a little noise
constexpr double kWindowSigmas = 2.0;
constexpr int kMaxIterations = 20;

int quantile(const Histogram& h, std::int64_t rank, bool from_dark) {
  std::int64_t seen = 0;
  for (int k = 0; k < 256; ++k) {
    const int g = from_dark ? k : 255 - k;
    seen += h[g];
    if (seen > rank) return g;
  }
  return from_dark ? 255 : 0;
}

int smoothedMode(const Histogram& h, int first, int last) {
  int best = first;
  std::int64_t best_score = -1;
  for (int c = first; c <= last; ++c) {
    std::int64_t score = 0;
    for (int d = -kSmoothing; d <= kSmoothing; ++d)
      if (c + d >= first && c + d <= last) score += std::int64_t{h[c + d]} * (kSmoothing + 1 - std::abs(d));
    if (score > best_score) {
      best_score = score;
      best = c;
    }
  }
  return best;
}

// Spread on the side that no edge pixel reaches.
double outerSigma(const Histogram& h, int mode, bool is_dark) {
  std::int64_t total = 0;
  for (int g = mode; g >= 0 && g < 256; g += is_dark ? -1 : 1) total += h[g];
  std::int64_t seen = 0;
  for (int g = mode; g >= 0 && g < 256; g += is_dark ? -1 : 1) {
    seen += h[g];
    if (2 * seen >= total) return kMadToSigma * std::abs(g - mode);
  }
  return 0.0;
}

// Level of the pixels first..last: mean within a window around the most frequent grey, recentred on itself.
double classLevel(const Histogram& h, int first, int last, bool is_dark) {
  const int mode = smoothedMode(h, first, last);
  const double half = std::max(kMinHalfWidth, kWindowSigmas * outerSigma(h, mode, is_dark));
  double level = mode;
  for (int pass = 0; pass < 3; ++pass) {
    double sum = 0.0, count = 0.0;
    for (int g = first; g <= last; ++g) {
      if (std::abs(g - level) > half) continue;
      sum += static_cast<double>(h[g]) * g;
      count += h[g];
    }
    if (count > 0.0) level = sum / count;
  }
  return level;
}

}  // namespace

std::array<int, 256> countGreys(const std::uint8_t* grey, int width_px, int height_px, std::size_t step_bytes) {
  std::array<std::array<int, 256>, 4> parts{};  // four, so that equal neighbours do not wait for each other
  constexpr int kBlock = 32, kWords = 4;
  // Blocks of one grey, most of an image, are compared with the last such block and counted when another comes.
  std::uint64_t last = 0;
  int blocks = 0;
  const auto flush = [&] { parts[0][last & 0xff] += kBlock * std::exchange(blocks, 0); };
  for (int v = 0; v < height_px; ++v) {
    const std::uint8_t* row = grey + v * step_bytes;
    int u = 0;
    for (; u + kBlock <= width_px; u += kBlock) {
      std::uint64_t words[kWords];
      std::memcpy(words, row + u, kBlock);
      const auto holds = [&words](std::uint64_t one) {
        return ((words[0] ^ one) | (words[1] ^ one) | (words[2] ^ one) | (words[3] ^ one)) == 0;
      };
      if (!holds(last)) {
        const std::uint64_t one = row[u] * std::uint64_t{0x0101010101010101};
        if (!holds(one)) {
          for (int k = 0; k < kBlock; ++k) ++parts[k % 4][row[u + k]];
          continue;
        }
        flush();
        last = one;
      }
      ++blocks;
    }
    for (; u < width_px; ++u) ++parts[0][row[u]];
  }
  flush();
  Histogram sum{};
  for (int g = 0; g < 256; ++g) sum[g] = parts[0][g] + parts[1][g] + parts[2][g] + parts[3][g];
  return sum;
}

std::optional<GreyLevels> estimateGreyLevels(const Histogram& histogram, ObjectShade object, int min_area_px,
                                             double min_contrast) {
  const int low = quantile(histogram, min_area_px / 2, true), high = quantile(histogram, min_area_px / 2, false);
  if (high - low < min_contrast) return std::nullopt;
  int split = (low + high) / 2;
  double dark = low, bright = high;
  for (int k = 0; k < kMaxIterations; ++k) {
    dark = classLevel(histogram, 0, split, true);
    bright = classLevel(histogram, split + 1, 255, false);
    const int next = std::clamp(static_cast<int>(std::floor(0.5 * (dark + bright))), 0, 254);
    if (next == split) break;
    split = next;
  }
  if (bright - dark < min_contrast) return std::nullopt;
  return object == ObjectShade::kDark ? GreyLevels{dark, bright} : GreyLevels{bright, dark};
}

std::optional<int> otsuThreshold(const Histogram& histogram) {
  double total = 0.0, sum = 0.0;
  for (int g = 0; g < 256; ++g) {
    total += histogram[g];
    sum += static_cast<double>(histogram[g]) * g;
  }
  double best = 0.0, n = 0.0, s = 0.0;
  int first = 0, last = 0;
  for (int g = 0; g < 255; ++g) {
    n += histogram[g];
    s += static_cast<double>(histogram[g]) * g;
    if (n == 0.0 || n == total) continue;
    const double difference = s / n - (sum - s) / (total - n);
    const double between = n * (total - n) * difference * difference;
    if (between > best) {
      best = between;
      first = last = g;
    } else if (between == best) {
      last = g;  // nothing between two levels: the middle of the gap
    }
  }
  if (best <= 0.0) return std::nullopt;
  return (first + last) / 2;
}

}  // namespace aras_visual_servo_camera
