// The centroid of the covered part of a pixel against the pixel cut by a line, corner by corner.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "polygon_moments.hpp"
#include "segmentation/edge_weights.hpp"

namespace aras_visual_servo_camera::covered_part_test {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kRounding = 1e-9;  // of the area that the cut is looked for by, over the smallest area below

// The part of the pixel where u cos + v sin >= c, by clipping its outline.
testing::Polygon cut(double angle, double c) {
  const testing::Polygon square{{-0.5, -0.5}, {0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}};
  testing::Polygon kept;
  for (std::size_t k = 0; k < 4; ++k) {
    const auto& p = square[k];
    const auto& q = square[(k + 1) % 4];
    const double a = p.x * std::cos(angle) + p.y * std::sin(angle) - c;
    const double b = q.x * std::cos(angle) + q.y * std::sin(angle) - c;
    if (a >= 0.0) kept.push_back(p);
    if ((a >= 0.0) != (b >= 0.0)) kept.push_back({p.x + a / (a - b) * (q.x - p.x), p.y + a / (a - b) * (q.y - p.y)});
  }
  return kept;
}

// The same, of a given area.
testing::Polygon cutOfArea(double angle, double area) {
  double low = -1.0, high = 1.0;
  for (int k = 0; k < 60; ++k) {
    const double c = 0.5 * (low + high);
    const testing::Polygon part = cut(angle, c);
    (part.size() > 2 && testing::polygonMoments(part, 0)[0] > area ? low : high) = c;
  }
  return cut(angle, low);
}

TEST(CoveredPart, HasTheCentroidOfThePixelCutByALineWhateverItsDirection) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  for (int k = 0; k < 2000; ++k) {
    const double angle = 2.0 * kPi * unit(random), weight = 0.01 + 0.98 * unit(random), length = 0.1 + unit(random);
    const std::vector<double> m = testing::polygonMoments(cutOfArea(angle, weight), 1);
    const PixelPoint part = centroidOfCoveredPart(weight, length * std::cos(angle), length * std::sin(angle));
    EXPECT_NEAR(part.u, m[1] / m[0], kRounding) << angle << " " << weight;
    EXPECT_NEAR(part.v, m[2] / m[0], kRounding) << angle << " " << weight;
  }
}

TEST(CoveredPart, OfAnEdgeAlongThePixelsLiesHalfWayIntoThem) {
  for (double weight : {0.1, 0.5, 0.9}) {
    const double off = 0.5 * (1.0 - weight);
    for (int sign : {-1, 1}) {
      EXPECT_NEAR(centroidOfCoveredPart(weight, sign * 3.0, 0.0).u, sign * off, kRounding);
      EXPECT_NEAR(centroidOfCoveredPart(weight, sign * 3.0, 0.0).v, 0.0, kRounding);
      EXPECT_NEAR(centroidOfCoveredPart(weight, 0.0, sign * 3.0).u, 0.0, kRounding);
      EXPECT_NEAR(centroidOfCoveredPart(weight, 0.0, sign * 3.0).v, sign * off, kRounding);
    }
  }
}

TEST(CoveredPart, IsTheCentreWhereThereIsNoEdge) {
  for (const auto& [weight, u, v] :
       {std::array<double, 3>{0.0, 1.0, 1.0}, {1.0, 1.0, 1.0}, {0.3, 0.0, 0.0}, {-0.1, 1.0, 0.0}, {1.1, 1.0, 0.0}}) {
    EXPECT_EQ(centroidOfCoveredPart(weight, u, v).u, 0.0);
    EXPECT_EQ(centroidOfCoveredPart(weight, u, v).v, 0.0);
  }
}

}  // namespace
}  // namespace aras_visual_servo_camera::covered_part_test
