#include "aras_visual_servo_sim/image/image.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "aras_visual_servo_sim/config/errors.hpp"

namespace aras_visual_servo_sim {
namespace {

Image grey(std::uint8_t value) {
  Image image;
  image.resize(320, 240, Encoding::kMono8);
  std::fill(image.data.begin(), image.data.end(), value);
  return image;
}

TEST(GaussianNoise, HasTheMeanAndDeviationAskedFor) {
  constexpr double kStddev = 5.0;
  Image image = grey(128);
  addGaussianNoise(image, kStddev, 1, 0);
  double sum = 0.0, squares = 0.0;
  for (const std::uint8_t x : image.data) {
    sum += x - 128.0;
    squares += (x - 128.0) * (x - 128.0);
  }
  const double n = static_cast<double>(image.data.size());
  EXPECT_NEAR(sum / n, 0.0, 4.0 * kStddev / std::sqrt(n));  // four standard errors
  const double expected = kStddev * kStddev + 1.0 / 12.0;   // rounding adds a twelfth
  EXPECT_NEAR(squares / n, expected, 4.0 * expected * std::sqrt(2.0 / n));
}

TEST(GaussianNoise, DependsOnSeedAndFrameAlone) {
  Image a = grey(100), b = grey(100), other_frame = grey(100), other_seed = grey(100);
  addGaussianNoise(a, 2.0, 7, 3);
  addGaussianNoise(b, 2.0, 7, 3);
  addGaussianNoise(other_frame, 2.0, 7, 4);
  addGaussianNoise(other_seed, 2.0, 8, 3);
  EXPECT_EQ(a.data, b.data);
  EXPECT_NE(a.data, other_frame.data);
  EXPECT_NE(a.data, other_seed.data);
}

TEST(GaussianNoise, NeighboursAndFramesAreNotCorrelated) {
  Image a = grey(128), b = grey(128);
  addGaussianNoise(a, 10.0, 7, 3);
  addGaussianNoise(b, 10.0, 7, 4);
  double neighbours = 0.0, frames = 0.0;
  const std::size_t n = a.data.size() - 1;
  for (std::size_t i = 0; i < n; ++i) {
    neighbours += (a.data[i] - 128.0) * (a.data[i + 1] - 128.0);
    frames += (a.data[i] - 128.0) * (b.data[i] - 128.0);
  }
  const double limit = 4.0 / std::sqrt(double(n));  // four standard errors of a correlation
  EXPECT_LT(std::abs(neighbours / n / 100.0), limit);
  EXPECT_LT(std::abs(frames / n / 100.0), limit);
}

TEST(GaussianNoise, IsClampedAndZeroDoesNothing) {
  Image dark = grey(0), bright = grey(255), same = grey(77);
  addGaussianNoise(dark, 3.0, 1, 1);
  addGaussianNoise(bright, 3.0, 1, 1);
  addGaussianNoise(same, 0.0, 1, 1);
  EXPECT_TRUE(std::all_of(dark.data.begin(), dark.data.end(), [](std::uint8_t x) { return x < 20; }));
  EXPECT_TRUE(std::all_of(bright.data.begin(), bright.data.end(), [](std::uint8_t x) { return x > 235; }));
  EXPECT_EQ(same.data, grey(77).data);
}

TEST(GaussianNoise, RejectsABadDeviation) {
  Image image = grey(0);
  EXPECT_THROW(addGaussianNoise(image, -1.0, 0, 0), ParameterError);
  EXPECT_THROW(addGaussianNoise(image, std::nan(""), 0, 0), ParameterError);
}

TEST(Encoding, NamesGoBothWaysAndOthersAreRejected) {
  for (const char* name : {"rgb8", "bgr8", "mono8"}) EXPECT_STREQ(encodingName(encodingFromName(name)), name);
  EXPECT_THROW(encodingFromName("rgb16"), ParameterError);
}

}  // namespace
}  // namespace aras_visual_servo_sim
