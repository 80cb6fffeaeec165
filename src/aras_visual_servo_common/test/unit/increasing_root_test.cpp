#include "aras_visual_servo_common/increasing_root.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <utility>

namespace aras_visual_servo_common::increasing_root_test {
namespace {

constexpr double kRounding = 4.0 * std::numeric_limits<double>::epsilon();

/** The root, and how many times the function was asked for it. */
template <class Function>
std::pair<double, int> rootOf(const Function& function, double wanted, double low, double high, double first) {
  int asked = 0;
  const auto counted = [&](double x) {
    ++asked;
    return function(x);
  };
  const double root = increasingRoot(counted, wanted, low, high, first);
  return {root, asked};
}

TEST(IncreasingRoot, IsFoundToRoundingInAFewSteps) {
  const auto cube = [](double x) { return ValueAndSlope{x * (1.0 + x * x), 1.0 + 3.0 * x * x}; };
  for (int k = 1; k < 1000; ++k) {
    const double there = 2.0 * k / 1000.0;
    const auto [root, asked] = rootOf(cube, cube(there).value, 0.0, 2.0, 1.0);
    EXPECT_NEAR(root, there, kRounding * there);
    EXPECT_LE(asked, 12);
  }
}

TEST(IncreasingRoot, OfTheIdentityIsTheValueItself) {
  const auto same = [](double x) { return ValueAndSlope{x, 1.0}; };
  for (const double wanted : {1e-300, 0.1, 0.7, 1.0 - 1e-16}) {
    EXPECT_EQ(increasingRoot(same, wanted, 0.0, 1.0, 0.5), wanted);
  }
}

TEST(IncreasingRoot, ArrivesWhateverTheSlopesAre) {
  const auto value = [](double x) { return std::atan(20.0 * (x - 0.3)); };  // from afar Newton's method runs away
  const auto slope = [](double x) { return 20.0 / (1.0 + 400.0 * (x - 0.3) * (x - 0.3)); };
  const auto found = [&](double times) {
    const auto function = [&](double x) { return ValueAndSlope{value(x), times * slope(x)}; };
    return rootOf(function, value(0.4), -5.0, 5.0, 4.9);
  };
  EXPECT_LE(found(1.0).second, 20);
  for (const double times : {1.0, 0.0, 0.5, 2.0, -1.0, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_NEAR(found(times).first, 0.4, 1e-15) << times;
    EXPECT_LE(found(times).second, 100) << times;
  }
}

TEST(IncreasingRoot, IsFoundAtTheEndsOfItsBracket) {
  const auto square = [](double x) { return ValueAndSlope{x * x, 2.0 * x}; };
  EXPECT_NEAR(increasingRoot(square, 0.0, 0.0, 3.0, 1.0), 0.0, 1e-30);
  EXPECT_EQ(increasingRoot(square, 9.0, 0.0, 3.0, 1.0), 3.0);
}

}  // namespace
}  // namespace aras_visual_servo_common::increasing_root_test
