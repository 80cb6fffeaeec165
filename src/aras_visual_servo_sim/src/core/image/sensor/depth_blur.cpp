#include "aras_visual_servo_sim/image/sensor/depth_blur.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "image/sensor/effects.hpp"

namespace aras_visual_servo_sim {
namespace {

constexpr int kStepsPerPx = 8;
constexpr int kBlock = 8;             // [px] wide and high
constexpr float kSameDepth = 1.001f;  // a surface aslant does not hide itself

}  // namespace

const DepthBlur::Disc& DepthBlur::disc(int step) {
  if (discs_.size() <= static_cast<std::size_t>(step)) discs_.resize(step + 1);
  Disc& found = discs_[step];
  if (found.shares.empty()) {
    const double diameter_px = double(step) / kStepsPerPx;
    found.reach = reachOfDisc(diameter_px);
    found.shares = found.reach == 0 ? std::vector<float>{1.0f} : discOf(diameter_px);
  }
  return found;
}

void DepthBlur::findReaches(int width, int height) {
  blocks_u_ = (width + kBlock - 1) / kBlock;
  const int blocks_v = (height + kBlock - 1) / kBlock;
  std::vector<int> own(std::size_t(blocks_u_) * blocks_v, 0);
  for (int v = 0; v < height; ++v) {
    for (int u = 0; u < width; ++u) {
      int& most = own[std::size_t(v / kBlock) * blocks_u_ + u / kBlock];
      most = std::max(most, disc(steps_[std::size_t(v) * width + u]).reach);
    }
  }
  reaches_ = own;
  for (int j = 0; j < blocks_v; ++j) {
    for (int i = 0; i < blocks_u_; ++i) {
      const int reach = own[std::size_t(j) * blocks_u_ + i], blocks = (reach + kBlock - 1) / kBlock;
      for (int y = std::max(0, j - blocks); y <= std::min(blocks_v - 1, j + blocks); ++y) {
        for (int x = std::max(0, i - blocks); x <= std::min(blocks_u_ - 1, i + blocks); ++x) {
          int& most = reaches_[std::size_t(y) * blocks_u_ + x];
          most = std::max(most, reach);
        }
      }
    }
  }
}

int DepthBlur::reachAbout(int u, int v) const { return reaches_[std::size_t(v / kBlock) * blocks_u_ + u / kBlock]; }

void DepthBlur::apply(const std::vector<float>& depth_m, FineImage& image) {
  const int width = image.width, height = image.height, channels = image.channels();
  steps_.resize(depth_m.size());
  std::transform(depth_m.begin(), depth_m.end(), steps_.begin(), [this](float depth) {
    return static_cast<std::uint16_t>(std::lround(kStepsPerPx * lens_.diameterPx(depth)));
  });
  const auto [least, most] = std::minmax_element(steps_.begin(), steps_.end());
  if (*least == *most) return defocus(double(*most) / kStepsPerPx, image);
  findReaches(width, height);
  const FineImage sharp = image;
  for (int v = 0; v < height; ++v) {
    for (int u = 0; u < width; ++u) {
      const int reach = reachAbout(u, v);
      if (reach == 0) continue;
      const std::size_t here = std::size_t(v) * width + u;
      const float behind = std::isnan(depth_m[here]) ? INFINITY : kSameDepth * depth_m[here];
      const int own_step = steps_[here];
      std::array<float, 3> sums{};
      float weights = 0.0f;
      for (int j = -reach; j <= reach; ++j) {
        const int row = std::clamp(v + j, 0, height - 1);
        for (int i = -reach; i <= reach; ++i) {
          const int column = std::clamp(u + i, 0, width - 1);
          const std::size_t there = std::size_t(row) * width + column;
          const bool hidden = !(depth_m[there] <= behind || std::isinf(behind));
          const Disc& spread = discs_[hidden ? std::min<int>(steps_[there], own_step) : steps_[there]];
          if (std::max(std::abs(i), std::abs(j)) > spread.reach) continue;
          const int side = 2 * spread.reach + 1;
          const float share = spread.shares[std::size_t(j + spread.reach) * side + i + spread.reach];
          const std::uint16_t* value = sharp.pixel(column, row);
          weights += share;
          for (int c = 0; c < channels; ++c) sums[c] += share * static_cast<float>(value[c]);
        }
      }
      std::uint16_t* to = image.pixel(u, v);
      for (int c = 0; c < channels; ++c) to[c] = static_cast<std::uint16_t>(sums[c] / weights + 0.5f);
    }
  }
}

}  // namespace aras_visual_servo_sim
