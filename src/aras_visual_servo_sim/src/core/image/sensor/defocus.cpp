#include "defocus.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "aras_visual_servo_sim/config/wide.hpp"

namespace aras_visual_servo_sim {
namespace {

ARAS_WIDE void addRow(const float* from, float share, int count, float* to) {
  for (int i = 0; i < count; ++i) to[i] += share * from[i];
}

}  // namespace

int reachOfDisc(double diameter_px) { return std::max(0, static_cast<int>(std::ceil(0.5 * diameter_px - 0.5))); }

std::vector<float> discOf(double diameter_px) {
  constexpr int kFine = 32;  // samples along a side of a pixel
  const int reach = reachOfDisc(diameter_px), side = 2 * reach + 1;
  std::vector<float> disc(static_cast<std::size_t>(side) * side);
  const double square = 0.25 * diameter_px * diameter_px;
  double sum = 0.0;
  for (int j = 0; j < side; ++j) {
    for (int i = 0; i < side; ++i) {
      int inside = 0;
      for (int k = 0; k < kFine * kFine; ++k) {
        const double x = i - reach - 0.5 + (k % kFine + 0.5) / kFine, y = j - reach - 0.5 + (k / kFine + 0.5) / kFine;
        if (x * x + y * y <= square) ++inside;
      }
      disc[static_cast<std::size_t>(j) * side + i] = static_cast<float>(inside);
      sum += inside;
    }
  }
  for (float& share : disc) share /= static_cast<float>(sum);
  return disc;
}

void defocus(double diameter_px, FineImage& image) {
  const int reach = reachOfDisc(diameter_px);
  if (reach == 0) return;  // the disc stays in its pixel
  const std::vector<float> disc = discOf(diameter_px);
  const int channels = image.channels(), side = 2 * reach + 1, count = image.width * channels;
  const std::size_t stride = static_cast<std::size_t>(image.width + 2 * reach) * channels;
  std::vector<float> padded(stride * (image.height + 2 * reach)), row(count);
  for (int v = 0; v < image.height + 2 * reach; ++v) {
    const std::uint16_t* from = image.pixel(0, std::clamp(v - reach, 0, image.height - 1));
    float* to = padded.data() + stride * v;
    for (int u = -reach; u < image.width + reach; ++u) {
      const std::uint16_t* pixel = from + std::clamp(u, 0, image.width - 1) * channels;
      for (int c = 0; c < channels; ++c) *to++ = pixel[c];
    }
  }
  for (int v = 0; v < image.height; ++v) {
    std::fill(row.begin(), row.end(), 0.5f);
    for (int j = 0; j < side; ++j) {
      for (int i = 0; i < side; ++i) {
        const float share = disc[static_cast<std::size_t>(j) * side + i];
        if (share > 0.0f)
          addRow(padded.data() + stride * (v + j) + std::size_t(i) * channels, share, count, row.data());
      }
    }
    std::uint16_t* to = image.pixel(0, v);
    for (int i = 0; i < count; ++i) to[i] = static_cast<std::uint16_t>(std::min(row[i], 65535.0f));
  }
}

}  // namespace aras_visual_servo_sim
