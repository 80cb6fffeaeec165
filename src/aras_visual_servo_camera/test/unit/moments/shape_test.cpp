// Numbers of a shape that hardly change with the view: from outlines, from the pixels of a mask, and their distance.
#include "moments/shape.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "aras_visual_servo_camera/moments/moments.hpp"
#include "polygon_moments.hpp"

namespace aras_visual_servo_camera::shape_test {
namespace {

using testing::Polygon;

TEST(Shape, SignatureIsThatOfTheShapeFromAnyDistanceAndSide) {
  constexpr double kAffine = 0.05;  // what of a perspective of this size is not affine
  const Polygon ell{{-0.06, -0.06}, {-0.02, -0.06}, {-0.02, 0.02}, {0.04, 0.02}, {0.04, 0.06}, {-0.06, 0.06}};
  const auto of = [](const Polygon& p) {
    return *shapeOf(testing::polygonMoments(p, 0)[0], testing::polygonCentredMoments(p, 3));
  };
  const ShapeSignature reference = of(testing::project(ell, {0, 0, 0.5, 0, 0, 0}));
  EXPECT_LT(dissimilarity(reference, of(testing::project(ell, {0.1, 0.05, 1.5, 2.0, 0, 0}))), 1e-9);
  EXPECT_LT(dissimilarity(reference, of(testing::project(ell, {0.0, 0.05, 0.8, 2.0, 0.5, -0.3}))), kAffine);
  const ShapeSignature disc = of(testing::ellipse(0.2, 0.1, 0.4, {0.1, 0.0}, 720)),
                       slab = of(testing::rectangle(0.3, 0.1));
  EXPECT_NEAR(disc.spread, 1.0, 1e-4);
  EXPECT_NEAR(slab.spread, 4.0 * 3.14159265358979323846 / 12.0, 1e-9);
  EXPECT_LT(slab.c21 + slab.c30 + disc.c21 + disc.c30, 1e-6);
  EXPECT_GT(dissimilarity(reference, disc), 0.3);
  EXPECT_FALSE(shapeOf(0.0, testing::polygonCentredMoments(ell, 3)).has_value());
}

TEST(Shape, EachMeasureCountsInTheDistance) {
  const ShapeSignature one{1.1, 0.2, 0.3};
  EXPECT_EQ(dissimilarity(one, one), 0.0);
  EXPECT_DOUBLE_EQ(dissimilarity(one, {1.5, 0.2, 0.3}), 0.4);
  EXPECT_DOUBLE_EQ(dissimilarity(one, {1.1, 0.6, 0.3}), 0.4);
  EXPECT_DOUBLE_EQ(dissimilarity(one, {1.1, 0.2, 0.7}), 0.4);
  EXPECT_DOUBLE_EQ(dissimilarity({1.3, 0.5, 0.9}, one), 0.7);
}

TEST(Shape, OfAMaskIsThatOfItsWeightsAboutTheirMean) {
  constexpr double kRounding = 1e-12;
  ObjectMask mask;
  for (int v = 50; v < 70; ++v) {
    mask.spans.push_back({v, 100 + v / 5, 130 + v});
    mask.edge.push_back({v, 130 + v, 0.3 + 0.01 * (v - 50)});
  }
  double m00 = 0.0, x = 0.0, y = 0.0;
  const auto forEach = [&mask](auto act) {
    for (const Span& s : mask.spans)
      for (int u = s.u_begin; u < s.u_end; ++u) act(u, s.v, 1.0);
    for (const EdgePixel& e : mask.edge) act(e.u, e.v, e.weight);
  };
  forEach([&](int u, int v, double weight) {
    m00 += weight;
    x += weight * u;
    y += weight * v;
  });
  for (const bool soft : {false, true}) {
    std::vector<double> mu(momentCount(3), 0.0);
    forEach([&](int u, int v, double weight) {
      for (int i = 0; i <= 3; ++i)
        for (int j = 0; i + j <= 3; ++j)
          mu[momentIndex(i, j)] += weight * std::pow(u - x / m00, i) * std::pow(v - y / m00, j);
    });
    const double smear = soft ? m00 / 12.0 : 0.0;  // of coverage by the square of a pixel
    mu[momentIndex(2, 0)] -= smear;
    mu[momentIndex(0, 2)] -= smear;
    mask.soft_edges = soft;
    // The mean that the mask carries is that of whole pixels, somewhere beside the weights'.
    for (const auto& [du, dv] : {std::pair(0.0, 0.0), std::pair(3.0, 2.0), std::pair(-4.0, 1.0)}) {
      mask.u_px = x / m00 + du;
      mask.v_px = y / m00 + dv;
      EXPECT_LT(dissimilarity(*shapeOf(mask), *shapeOf(m00, mu)), kRounding) << soft << du;
    }
  }
}

TEST(Shape, IsNothingForNoPixelsAPointOrALine) {
  ObjectMask mask;
  EXPECT_FALSE(shapeOf(mask).has_value());
  mask.spans = {{50, 100, 101}};
  EXPECT_FALSE(shapeOf(mask).has_value());
  mask.spans = {{50, 100, 140}};
  mask.u_px = 119.5;
  mask.v_px = 50.0;
  EXPECT_FALSE(shapeOf(mask).has_value());
  mask.spans.push_back({51, 100, 140});
  EXPECT_TRUE(shapeOf(mask).has_value());
  const std::vector<double> mu = testing::polygonCentredMoments(testing::triangle(0.1), 3);
  EXPECT_TRUE(shapeOf(mu[0], mu).has_value());
  EXPECT_FALSE(shapeOf(mu[0], {mu.begin(), mu.begin() + 6}).has_value()) << "moments to order 2";
}

}  // namespace
}  // namespace aras_visual_servo_camera::shape_test
