// How well edge pixels tell where a side is, on squares whose weights are exact, rounded, sampled or noisy.
#include "segmentation/edge_step.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace aras_visual_servo_camera::edge_step_test {
namespace {

constexpr int kSide = 100;
constexpr double kContrast = 200.0;

/** A square whose upper left corner is at (u, v), its sides inclined by `slope`; weights rounded to multiples of
 * `step`. */
ObjectMask square(double u, double v, double slope, double step, double noise, std::mt19937* random) {
  std::normal_distribution<double> normal(0.0, noise > 0.0 ? noise : 1.0);
  ObjectMask mask;
  mask.visible = mask.soft_edges = true;
  mask.grey_step = 1.0 / kContrast;
  const auto weightOf = [&](double exact) {
    const double drawn =
        std::round(std::min(std::max(exact, 0.0), 1.0) / step) * step + (noise > 0.0 ? normal(*random) : 0.0);
    return std::round(drawn * kContrast) / kContrast;
  };
  const int left = static_cast<int>(std::floor(u)), top = static_cast<int>(std::floor(v));
  for (int row = top; row <= top + kSide; ++row) {
    for (int column = left; column <= left + kSide; ++column) {
      const double a = column - u - slope * (row - top) + 1.0, b = row - v + slope * (column - left) + 1.0;
      const double exact = std::min({a, kSide + 1.0 - a, 1.0}) * std::min({b, kSide + 1.0 - b, 1.0});
      if (row > top && row < top + kSide && column > left && column < left + kSide && exact >= 1.0) {
        mask.spans.push_back({row, column, column + 1});
      } else if (exact > 0.0) {
        mask.edge.push_back({row, column, weightOf(exact)});
      }
    }
  }
  return mask;
}

/** What is told of the last of many squares, of which each lies elsewhere. */
double afterMotion(double slope, double step, double noise, int images = 200) {
  std::mt19937 random(5);
  EdgeStep edge_step;
  for (int k = 0; k < images; ++k)
    edge_step.process(square(20.0 + 0.237 * k, 30.0 + 0.171 * k, slope, step, noise, &random), 1);
  return edge_step.process(square(20.3, 30.4, slope, step, noise, &random), 1);
}

TEST(EdgeStep, IsHalfAPixelForHardEdges) {
  ObjectMask mask;
  mask.visible = true;
  EXPECT_EQ(EdgeStep().process(mask, 1), 0.5);
  EXPECT_TRUE(std::isnan(EdgeStep().process(ObjectMask(), 1)));
}

TEST(EdgeStep, IsAboutHalfAGreyLevelWhereAllPixelsOfASideRoundAlike) {
  const double told = afterMotion(0.0, 1e-9, 0.0);
  EXPECT_LE(told, 0.5 / kContrast);
  EXPECT_GT(told, 0.25 / kContrast);  // the corners are runs of their own
}

TEST(EdgeStep, IsLessWhereASlopeOrNoiseMakesPixelsRoundDifferently) {
  const double alike = afterMotion(0.0, 1e-9, 0.0);
  EXPECT_LT(afterMotion(0.05, 1e-9, 0.0), 0.2 * alike);
  EXPECT_LT(afterMotion(0.0, 1e-9, 0.5 / kContrast), 0.2 * alike);
}

TEST(EdgeStep, IsThatOfTheSamplesThatAPixelWasDrawnBy) {
  EXPECT_GT(afterMotion(0.0, 0.25, 0.0), 0.05);
  EXPECT_LT(afterMotion(0.0, 0.25, 0.0), 0.15);
  EXPECT_GT(afterMotion(0.0, 0.25, 1.0 / kContrast), 0.05);  // noise comes after the samples
}

TEST(EdgeStep, TellsSamplesOnlyFromAnObjectThatHasMoved) {
  std::mt19937 random(5);
  EdgeStep edge_step;
  double told = 0.0;
  for (int k = 0; k < 500; ++k) told = edge_step.process(square(20.3, 30.4, 0.0, 1e-9, 0.0, &random), 1);
  EXPECT_LT(told, 1.0 / kContrast);
  edge_step.forget();
  EXPECT_EQ(edge_step.process(square(20.3, 30.4, 0.0, 1e-9, 0.0, &random), 1), told);
}

}  // namespace
}  // namespace aras_visual_servo_camera::edge_step_test
