#include "pixel_samples.hpp"

#include <cmath>

#include "aras_visual_servo_sim/config/wide.hpp"
#include "eight.hpp"

namespace aras_visual_servo_sim {
namespace {

constexpr int kCount = PixelSamples::kCount, kSide = PixelSamples::kSide;

/** Where the samples are: column and row in 64ths of a pixel, and from its middle [px]. */
struct Pattern {
  std::array<std::int32_t, kCount> column{}, row{};
  std::array<float, kCount> x{}, y{};
};

constexpr Pattern makePattern() {
  Pattern pattern;
  for (int k = 0; k < kCount; ++k) {
    const int i = k % kSide, j = k / kSide;
    pattern.column[k] = i * kSide + j;
    pattern.row[k] = j * kSide + i;
    pattern.x[k] = (pattern.column[k] + 0.5f) / kCount - 0.5f;
    pattern.y[k] = (pattern.row[k] + 0.5f) / kCount - 0.5f;
  }
  return pattern;
}
constexpr Pattern kPattern = makePattern();

static_assert(kSide == 8, "a row of the grid is EightFloats");

/** A linear function of the place, a x + b y + c: in row j of the grid it is first + j * step. */
struct Linear {
  EightFloats first;
  float step;

  [[gnu::always_inline]] void set(float a, float b, float c) {
    first = a * eightAt(kPattern.x.data()).values + b * eightAt(kPattern.y.data()).values + c;
    step = a * (1.0f / kCount) + b * (1.0f / kSide);
  }
};

template <int kEdges, bool kBounded>
[[gnu::always_inline]] inline void seeTriangle(const PixelSamples::Triangle& t, std::int32_t index, float* nearest,
                                               std::int32_t* seen) {
  Linear depth, edges[3];
  depth.set(t.z_x, t.z_y, t.z);
  for (int k = 0; k < kEdges; ++k) edges[k].set(t.a[k], t.b[k], t.c[k]);
  for (int j = 0; j < kSide; ++j, nearest += kSide, seen += kSide) {
    auto& near = eightAt(nearest);
    auto& visible = eightAt(seen);
    const auto rows = static_cast<float>(j);
    const EightFloats z = depth.first + rows * depth.step;
    EightInts inside = z > near.values;
    if constexpr (kBounded) inside &= z <= t.most;
    for (int k = 0; k < kEdges; ++k) inside &= edges[k].first + rows * edges[k].step >= t.least[k];
    near.values = inside ? z : near.values;
    visible.values = inside ? index : visible.values;
  }
}

ARAS_WIDE void seeWhole(const PixelSamples::Triangle& t, std::int32_t index, float* nearest, std::int32_t* seen) {
  seeTriangle<0, false>(t, index, nearest, seen);
}
ARAS_WIDE void seeOneEdge(const PixelSamples::Triangle& t, std::int32_t index, float* nearest, std::int32_t* seen) {
  seeTriangle<1, false>(t, index, nearest, seen);
}
ARAS_WIDE void seeTwoEdges(const PixelSamples::Triangle& t, std::int32_t index, float* nearest, std::int32_t* seen) {
  seeTriangle<2, false>(t, index, nearest, seen);
}
ARAS_WIDE void seeThreeEdges(const PixelSamples::Triangle& t, std::int32_t index, float* nearest, std::int32_t* seen) {
  seeTriangle<3, false>(t, index, nearest, seen);
}
/** Where the near plane may cut it. @pre it has all three edges */
ARAS_WIDE void seeBounded(const PixelSamples::Triangle& t, std::int32_t index, float* nearest, std::int32_t* seen) {
  seeTriangle<3, true>(t, index, nearest, seen);
}

ARAS_WIDE void seeCurved(const PixelSamples::Curved& c, std::int32_t index, float* nearest, std::int32_t* seen) {
  const float w0 = c.within[0], w_x = c.within[1], w_y = c.within[2];
  const float w_xx = c.within[3], w_xy = c.within[4], w_yy = c.within[5];
  const float z0 = c.z[0], z_x = c.z[1], z_y = c.z[2], root = c.root, least = c.least, most = c.most;
  const float a0 = c.bounds[0][0], a_x = c.bounds[0][1], a_y = c.bounds[0][2], a_z = c.bounds[0][3];
  const float b0 = c.bounds[1][0], b_x = c.bounds[1][1], b_y = c.bounds[1][2], b_z = c.bounds[1][3];
  for (int i = 0; i < kCount; ++i) {
    const float x = kPattern.x[i], y = kPattern.y[i];
    const float w = w0 + x * (w_x + w_xx * x + w_xy * y) + y * (w_y + w_yy * y);
    const float z = z0 + z_x * x + z_y * y + root * std::sqrt(w > 0.0f ? w : 0.0f);
    const std::int32_t inside = -std::int32_t(w >= 0.0f) & -std::int32_t(a0 + a_x * x + a_y * y + a_z * z >= 0.0f) &
                                -std::int32_t(b0 + b_x * x + b_y * y + b_z * z >= 0.0f) & -std::int32_t(z >= least) &
                                -std::int32_t(z <= most) & -std::int32_t(z > nearest[i]);
    nearest[i] = inside != 0 ? z : nearest[i];
    seen[i] = inside != 0 ? index : seen[i];
  }
}

ARAS_WIDE void countSamples(std::int32_t index, const std::int32_t* seen, std::int32_t* sums) {
  std::int32_t count = 0, columns = 0, rows = 0;
  for (int i = 0; i < kCount; ++i) {
    const std::int32_t mine = -std::int32_t(seen[i] == index);
    count -= mine;
    columns += mine & kPattern.column[i];
    rows += mine & kPattern.row[i];
  }
  sums[0] = count;
  sums[1] = columns;
  sums[2] = rows;
}

}  // namespace

Eigen::Vector2d PixelSamples::place(int sample) { return {kPattern.x[sample], kPattern.y[sample]}; }

void PixelSamples::clear(std::int32_t nothing) {
  nearest_.fill(0.0f);
  seen_.fill(nothing);
}

void PixelSamples::see(const Triangle& triangle, std::int32_t index) {
  constexpr decltype(&seeWhole) kSee[] = {seeWhole, seeOneEdge, seeTwoEdges, seeThreeEdges};
  (triangle.most < kAnyDepth ? seeBounded : kSee[triangle.edges])(triangle, index, nearest_.data(), seen_.data());
}

void PixelSamples::see(const Curved& curved, std::int32_t index) {
  seeCurved(curved, index, nearest_.data(), seen_.data());
}

PixelSamples::Share PixelSamples::shareOf(std::int32_t index) const {
  std::int32_t sums[3];
  countSamples(index, seen_.data(), sums);
  if (sums[0] == 0) return {0, 0.0, 0.0};
  const double scale = 1.0 / kCount, mean = 1.0 / sums[0];
  return {sums[0], (sums[1] * mean + 0.5) * scale - 0.5, (sums[2] * mean + 0.5) * scale - 0.5};
}

}  // namespace aras_visual_servo_sim
