// What the pixels of a tile see of a triangle, against the corners of their squares.
#include "render/tiles/tile_sight.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace aras_visual_servo_sim::tile_sight_test {
namespace {

constexpr int kSide = TileBins::kTile;
constexpr double kRounding = 1e-5;
constexpr float kFloor = 0.3f, kAhead = 0.9f;
constexpr PixelBox kSome{3, 2, kSide - 1, kSide - 4};  // of the tile's pixels

/** Rays of a tile that starts at the image's middle. bent: every pixel's square is turned and skewed a little. */
PixelRays raysAt(int pixel, bool bent) {
  constexpr double kFocal_px = 100.0;
  const double u = pixel % kSide, v = pixel / kSide;  // NOLINT
  PixelRays rays{{u / kFocal_px, v / kFocal_px, 1.0}, {1.0 / kFocal_px, 0.0, 0.0}, {0.0, 1.0 / kFocal_px, 0.0}};
  if (bent) {
    rays.middle.z() = 1.0 + 0.01 * (u - v);
    rays.across += Eigen::Vector3d(0.001, 0.003, -0.002);
    rays.down += Eigen::Vector3d(-0.002, 0.001, 0.001);
  }
  return rays;
}

/** Three half-planes and a plane, of which about half the pixels see something. */
TileTriangle anyTriangle(std::mt19937& random, bool flat) {
  std::uniform_real_distribution<float> unit(-1.0f, 1.0f);
  TileTriangle t{};
  for (int k = 0; k < 3; ++k) {
    t.a[k] = unit(random);
    t.b[k] = unit(random);
    t.c[k] = -0.5f * kSide * (t.a[k] + t.b[k]) + 4.0f + 4.0f * unit(random);
    if (!flat) {
      for (float& x : t.edge[k]) x = unit(random);
      t.edge[k][2] = 0.1f * unit(random);
    }
  }
  t.plane[0] = unit(random);
  t.plane[1] = unit(random);
  t.plane[2] = 0.6f + 0.4f * unit(random);
  t.bias = 0.01f;
  t.most = 0.8f + 0.4f * unit(random);
  return t;
}

struct Range {
  double least = 1e9, most = -1e9;
  void add(double value) {
    least = std::min(least, value);
    most = std::max(most, value);
  }
};

class Sight : public ::testing::TestWithParam<bool> {
 protected:
  Sight() {
    for (int p = 0; p < TileRays::kPixels; ++p) rays_.set(p, raysAt(p, !flat()));
    floor_.fill(kFloor);
    ahead_.fill(kAhead);
  }
  static bool flat() { return GetParam(); }

  /** Of edge k, 3: of the depth, over the corners of a pixel's square. */
  static Range overCorners(const TileTriangle& t, int k, int p) {
    Range range;
    for (const double x : {-0.5, 0.5}) {
      for (const double y : {-0.5, 0.5}) {
        const Eigen::Vector3d ray = raysAt(p, !flat()).at(x, y);
        if (k == 3) {
          range.add(t.plane[0] * ray.x() + t.plane[1] * ray.y() + t.plane[2] * ray.z() + t.bias);
        } else if (flat()) {
          range.add(t.a[k] * (p % kSide + 0.5 + x) + t.b[k] * (p / kSide + 0.5 + y) + t.c[k]);  // NOLINT
        } else {
          range.add(t.edge[k][0] * ray.x() + t.edge[k][1] * ray.y() + t.edge[k][2] * ray.z());
        }
      }
    }
    return range;
  }

  TileRays rays_;
  TileSight sight_;
  std::array<float, TileRays::kPixels> floor_{}, ahead_{};
};

TEST_P(Sight, IsWhatTheCornersOfThePixelsSay) {
  std::mt19937 random(1);
  int crossed = 0, whole = 0, aside = 0, cut = 0, hidden = 0, ahead = 0;
  for (int round = 0; round < 200; ++round) {
    const TileTriangle t = anyTriangle(random, flat());
    sight_.look(t, flat(), rays_, floor_.data(), ahead_.data(), kSome.v0, kSome.v1);
    for (int v = kSome.v0; v < kSome.v1; ++v) {
      for (int u = kSome.u0; u < kSome.u1; ++u) {
        const int p = v * kSide + u;
        bool nothing = false, clear = true;
        for (int k = 0; k < 3; ++k) {
          const Range edge = overCorners(t, k, p);
          clear = clear && std::abs(edge.least) > kRounding && std::abs(edge.most) > kRounding;
          nothing = nothing || edge.most < 0.0;
          aside += edge.most < 0.0;
          if (std::abs(edge.least) < kRounding) continue;
          EXPECT_EQ((sight_.of(p) >> k & 1) != 0, edge.least < 0.0) << "edge " << k << " of pixel " << p;
          ++(edge.least < 0.0 ? crossed : whole);
        }
        Range depth = overCorners(t, 3, p);
        depth.most = std::min(depth.most, double(t.most));
        EXPECT_NEAR(sight_.nearest(p), depth.most, kRounding);
        EXPECT_NEAR(sight_.farthest(p), depth.least, kRounding);
        clear = clear && std::abs(depth.most - kFloor) > kRounding && std::abs(depth.most - kAhead) > kRounding &&
                std::abs(depth.least - kAhead) > kRounding;
        if (!clear) continue;
        hidden += depth.most < kFloor;
        ahead += depth.least > kAhead;
        cut += depth.most > kAhead;
        EXPECT_EQ((sight_.of(p) & TileSight::kNothing) != 0, nothing || depth.most < kFloor || depth.least > kAhead)
            << "pixel " << p;
        EXPECT_EQ((sight_.of(p) & TileSight::kCut) != 0, depth.most > kAhead) << "pixel " << p;
      }
    }
  }
  for (const int count : {crossed, whole, aside, cut, hidden, ahead}) EXPECT_GT(count, 50);
}

INSTANTIATE_TEST_SUITE_P(FlatAndThroughALens, Sight, ::testing::Values(true, false));

}  // namespace
}  // namespace aras_visual_servo_sim::tile_sight_test
