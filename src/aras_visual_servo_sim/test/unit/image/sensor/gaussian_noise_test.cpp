#include "aras_visual_servo_sim/image/sensor/gaussian_noise.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "aras_visual_servo_sim/config/errors.hpp"

namespace aras_visual_servo_sim::gaussian_noise_test {
namespace {

/** An image of one grey level with noise. */
Image noisy(double level, double stddev, std::uint64_t seed, std::uint64_t frame, double mean = 0.0) {
  FineImage light;
  light.resize(320, 240, Encoding::kMono8);
  std::fill(light.data.begin(), light.data.end(), static_cast<std::uint16_t>(std::lround(257.0 * level)));
  Image image;
  addGaussianNoise(light, stddev, seed, frame, mean, light.encoding, image);
  return image;
}

double meanOf(const Image& image) {
  double sum = 0.0;
  for (const std::uint8_t x : image.data) sum += x;
  return sum / static_cast<double>(image.data.size());
}

TEST(GaussianNoise, HasTheMeanAndDeviationAskedFor) {
  constexpr double kStddev = 5.0;
  const Image image = noisy(128, kStddev, 1, 0);
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
  const Image a = noisy(100, 2.0, 7, 3);
  EXPECT_EQ(a.data, noisy(100, 2.0, 7, 3).data);
  EXPECT_NE(a.data, noisy(100, 2.0, 7, 4).data);
  EXPECT_NE(a.data, noisy(100, 2.0, 8, 3).data);
}

TEST(GaussianNoise, NeighboursAndFramesAreNotCorrelated) {
  const Image a = noisy(128, 10.0, 7, 3), b = noisy(128, 10.0, 7, 4);
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

TEST(GaussianNoise, IsClampedAndZeroRounds) {
  const Image dark = noisy(0, 3.0, 1, 1), bright = noisy(255, 3.0, 1, 1);
  EXPECT_TRUE(std::all_of(dark.data.begin(), dark.data.end(), [](std::uint8_t x) { return x < 20; }));
  EXPECT_TRUE(std::all_of(bright.data.begin(), bright.data.end(), [](std::uint8_t x) { return x > 235; }));
  for (const auto& [level, byte] : {std::pair{77.0, 77}, {76.6, 77}, {77.4, 77}, {0.0, 0}, {255.0, 255}}) {
    const Image image = noisy(level, 0.0, 1, 1);
    EXPECT_TRUE(std::all_of(image.data.begin(), image.data.end(), [b = byte](int x) { return x == b; })) << level;
  }
  EXPECT_EQ(noisy(77.4, 0.0, 1, 1, 0.2).data.front(), 78);
}

TEST(GaussianNoise, KeepsWhatLiesBetweenGreyLevels) {
  // Rounding before the noise would leave the mean off by up to half a level. After noise of one level rounding has
  // no bias left (2 exp(-2 pi^2) / (2 pi), 1e-9 levels).
  for (const double level : {20.3, 100.5, 230.7}) {
    const double error = std::sqrt((1.0 + 1.0 / 12.0) / (320.0 * 240.0));
    EXPECT_NEAR(meanOf(noisy(level, 1.0, 3, 5)), level, 4.0 * error + 0.5 / 257.0);  // four standard errors
  }
}

TEST(GaussianNoise, RejectsABadDeviation) {
  EXPECT_THROW(noisy(0, -1.0, 0, 0), ParameterError);
  EXPECT_THROW(noisy(0, std::nan(""), 0, 0), ParameterError);
}

}  // namespace
}  // namespace aras_visual_servo_sim::gaussian_noise_test
