// What the 64 samples of a pixel say about triangles.
#include "render/pixels/pixel_samples.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace aras_visual_servo_sim::pixel_samples_test {
namespace {

/** The side of a line through (x0, y0) at an angle that its normal points to, or the other; at inverse depth z. */
PixelSamples::Triangle side(double angle, double x0, double y0, float z, bool other = false) {
  const float sign = other ? -1.0f : 1.0f;
  const auto a = static_cast<float>(std::cos(angle)), b = static_cast<float>(std::sin(angle));
  const auto c = static_cast<float>(-(std::cos(angle) * x0 + std::sin(angle) * y0));
  const float least = other ? 1e-45f : 0.0f;
  return {1, {sign * a}, {sign * b}, {sign * c}, {least}, z, 0.0f, 0.0f};
}

TEST(PixelSamples, EachLiesOnOneSideOfASharedEdge) {
  for (int k = 0; k < 500; ++k) {
    // Every eighth edge goes through samples: their columns and rows are odd 128ths.
    const double angle = k % 8 == 0 ? (k % 16 == 0 ? 0.0 : M_PI / 2) : 0.0126 * k;
    const double at = k % 8 == 0 ? (2 * (k % 64) + 1) / 128.0 - 0.5 : 0.4 * std::sin(7.0 * k);
    PixelSamples samples;
    samples.clear(2);
    samples.see(side(angle, at, at, 0.1f), 0);
    samples.see(side(angle, at, at, 0.1f, true), 1);
    EXPECT_EQ(samples.shareOf(0).count + samples.shareOf(1).count, PixelSamples::kCount) << k;
    EXPECT_EQ(samples.shareOf(2).count, 0) << k;
  }
}

TEST(PixelSamples, MeasureUprightEdgesToOne128th) {
  for (double at = -0.5; at <= 0.5; at += 0.00731) {
    for (const double angle : {0.0, M_PI / 2}) {
      PixelSamples samples;
      samples.clear(1);
      samples.see(side(angle, at, at, 0.1f), 0);
      constexpr double kRounding = 1e-6;
      EXPECT_NEAR(samples.shareOf(0).count / 64.0, 0.5 - at, 1.0 / 128.0 + kRounding);
    }
  }
}

TEST(PixelSamples, NearerOnesHideFartherOnesInEitherOrder) {
  for (const bool far_first : {true, false}) {
    PixelSamples samples;
    samples.clear(2);
    samples.see(side(0.3, 0.1, 0.1, far_first ? 0.1f : 0.2f), far_first ? 0 : 1);
    samples.see(side(2.0, 0.0, 0.1, far_first ? 0.2f : 0.1f), far_first ? 1 : 0);
    PixelSamples near;
    near.clear(2);
    near.see(side(far_first ? 2.0 : 0.3, far_first ? 0.0 : 0.1, 0.1, 0.2f), 1);
    EXPECT_EQ(samples.shareOf(1).count, near.shareOf(1).count);
  }
}

TEST(PixelSamples, SeeWhatLiesInsideEachEdgeAndBehindTheNearPlane) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> unit(-1.0f, 1.0f);
  for (int round = 0; round < 400; ++round) {
    PixelSamples::Triangle t{};
    t.edges = round % 4;
    for (int k = 0; k < 3; ++k) {  // those beyond t.edges would hide everything
      t.a[k] = unit(random);
      t.b[k] = unit(random);
      t.c[k] = k < t.edges ? 0.3f * unit(random) + 0.2f : -9.0f;
    }
    t.z = 0.5f;
    t.z_x = 0.3f * unit(random);
    t.z_y = 0.3f * unit(random);
    const bool bounded = t.edges == 3 && round % 8 > 3;
    if (bounded) t.most = 0.5f;
    PixelSamples samples;
    samples.clear(1);
    samples.see(t, 0);
    int least = 0, most = 0;  // without and with the samples that rounding may move
    constexpr double kRounding = 1e-6;
    for (int k = 0; k < PixelSamples::kCount; ++k) {
      const Eigen::Vector2d at = PixelSamples::place(k);
      double inside = bounded ? t.most - (t.z + t.z_x * at.x() + t.z_y * at.y()) : 1.0;
      for (int e = 0; e < t.edges; ++e) inside = std::min(inside, t.a[e] * at.x() + t.b[e] * at.y() + t.c[e]);
      least += inside > kRounding;
      most += inside > -kRounding;
    }
    EXPECT_GE(samples.shareOf(0).count, least) << t.edges << " edges";
    EXPECT_LE(samples.shareOf(0).count, most) << t.edges << " edges";
  }
}

TEST(PixelSamples, ShareLiesWhereItsSamplesAre) {
  PixelSamples samples;
  samples.clear(1);
  samples.see(side(0.0, 0.0, 0.0, 0.1f), 0);  // the right half
  const PixelSamples::Share share = samples.shareOf(0);
  EXPECT_EQ(share.count, 32);
  EXPECT_DOUBLE_EQ(share.x, 0.25);
  EXPECT_NEAR(share.y, 0.0, 1.0 / 16.0);  // the shear couples rows to columns
}

}  // namespace
}  // namespace aras_visual_servo_sim::pixel_samples_test
