// The parts of a sensor, each alone.
#include "image/sensor/effects.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "aras_visual_servo_sim/image/sensor/jpeg.hpp"

namespace aras_visual_servo_sim::effects_test {
namespace {

TEST(ShotNoise, HasTheMeanAndVarianceOfPoisson) {
  constexpr int kDraws = 1 << 16;  // evenly over the random words: quadrature, no chance
  for (const double mean : {0.01, 0.5, 3.0, 17.0, 29.9, 30.1, 100.0, 5000.0}) {
    double sum = 0.0, squares = 0.0;
    for (int k = 0; k < kDraws; ++k) {
      const auto bits = static_cast<std::uint32_t>(k) * 65536u + 32768u;
      const double x = shotNoise(static_cast<float>(mean), bits, normalQuantiles().data());
      ASSERT_GE(x, 0.0);
      sum += x - mean;
      squares += (x - mean) * (x - mean);
    }
    // What quadrature leaves out of the tails: some 4 sigma at one part in 2^16.
    const double tolerance = 2e-4 * std::max(std::sqrt(mean), 1.0);
    EXPECT_NEAR(sum / kDraws, 0.0, tolerance) << mean;
    EXPECT_NEAR(squares / kDraws / mean, 1.0, 3e-3) << mean;
  }
  EXPECT_EQ(shotNoise(0.0f, 12345u, normalQuantiles().data()), 0.0f);
  EXPECT_EQ(shotNoise(-1.0f, 12345u, normalQuantiles().data()), 0.0f);
}

TEST(FixedPattern, HasItsDeviationAndBelongsToItsSeed) {
  constexpr std::size_t kCount = 100000;
  const std::vector<float> pattern = fixedPattern(3.0, kCount, 7);
  double sum = 0.0, squares = 0.0;
  for (const float x : pattern) {
    sum += x;
    squares += x * x;
  }
  EXPECT_NEAR(sum / kCount, 0.0, 4.0 * 3.0 / std::sqrt(kCount));  // four standard errors
  EXPECT_NEAR(squares / kCount, 9.0, 4.0 * 9.0 * std::sqrt(2.0 / kCount));
  EXPECT_EQ(pattern, fixedPattern(3.0, kCount, 7));
  EXPECT_NE(pattern, fixedPattern(3.0, kCount, 8));
  EXPECT_TRUE(fixedPattern(0.0, kCount, 7).empty());
}

TEST(Bayer, EachPatternIsTheFirstTwoRowsOfItsName) {
  FineImage rgb, mosaic;
  rgb.resize(4, 3, Encoding::kRgb8);
  for (std::size_t i = 0; i < rgb.data.size(); ++i) rgb.data[i] = static_cast<std::uint16_t>("rgb"[i % 3]);
  for (const char* name : {"bayer_rggb8", "bayer_bggr8", "bayer_gbrg8", "bayer_grbg8"}) {
    throughBayerFilter(rgb, encodingFromName(name), mosaic);
    ASSERT_EQ(mosaic.data.size(), 12u);
    EXPECT_STREQ(encodingName(mosaic.encoding), name);
    const std::string pattern = std::string(name).substr(6, 4);
    for (int v = 0; v < 3; ++v) {
      for (int u = 0; u < 4; ++u) EXPECT_EQ(*mosaic.pixel(u, v), pattern[2 * (v % 2) + u % 2]) << name << u << v;
    }
  }
}

TEST(Defocus, EdgeIsThatOfADiscAndFlatStaysFlat) {
  constexpr double kDiameter = 9.0, kRadius = 0.5 * kDiameter;
  constexpr int kWidth = 64, kEdge = 32;
  FineImage image;
  image.resize(kWidth, 32, Encoding::kMono8);
  for (int v = 0; v < 32; ++v) {
    for (int u = 0; u < kWidth; ++u) *image.pixel(u, v) = u < kEdge ? 10000 : 60000;
  }
  defocus(kDiameter, image);
  for (int u = 0; u < kWidth; ++u) {
    // The part of a disc about the pixel's middle that lies beyond the edge.
    const double x = std::clamp((u - (kEdge - 0.5)) / kRadius, -1.0, 1.0);
    const double share = 0.5 + (std::asin(x) + x * std::sqrt(1.0 - x * x)) / M_PI;
    // Shares of the disc are counted on a grid of 1/32 px: its area to 1e-3.
    EXPECT_NEAR(*image.pixel(u, 16), 10000 + 50000 * share, 2e-3 * 50000) << u;
  }
  FineImage sharp = image;
  defocus(0.0, sharp);
  EXPECT_EQ(sharp.data, image.data);
}

TEST(ToneCurve, HasNumbersInTheUpperBitsAfterGamma) {
  const std::vector<std::uint16_t> plain = toneCurve(8, 1.0), twelve = toneCurve(12, 1.0), lifted = toneCurve(8, 2.2);
  for (int k = 0; k < 256; ++k) {
    EXPECT_EQ(plain[k], k << 8);
    EXPECT_EQ(twelve[16 * k], k << 8);
    EXPECT_EQ(twelve[16 * k + 15], (16 * k + 15) << 4);
    EXPECT_NEAR(lifted[k] >> 8, 255.0 * std::pow(k / 255.0, 1.0 / 2.2), 0.5 + 1e-9);
  }
  EXPECT_EQ(toneCurve(1, 1.0), (std::vector<std::uint16_t>{0, 1 << 15}));
}

TEST(AutoExposure, GoesItsShareOfTheWayBothWaysAndStopsAtTheLimits) {
  const AutoExposureConfig config{0.4, 0.5, 1, 0.1, 2.0, 4.0};
  EXPECT_NEAR(nextBrightness(config, 1.0, 0.1), 2.0, 1e-12);  // half of two stops
  EXPECT_NEAR(nextBrightness(config, 1.0, 0.9), std::sqrt(0.4 / 0.9), 1e-12);
  EXPECT_EQ(nextBrightness(config, 7.9, 0.01), 8.0);
  EXPECT_EQ(nextBrightness(config, 0.11, 0.99), 0.1);
  EXPECT_EQ(nextBrightness(config, 1.0, 0.0), nextBrightness(config, 1.0, 1e-3));
  EXPECT_EQ(exposureOf(config, 0.5).exposure, 0.5);
  EXPECT_EQ(exposureOf(config, 0.5).gain, 1.0);
  EXPECT_EQ(exposureOf(config, 6.0).exposure, 2.0);
  EXPECT_EQ(exposureOf(config, 6.0).gain, 3.0);
}

TEST(AutoWhiteBalance, MakesMeansAlikeWithinItsLimit) {
  const AutoWhiteBalanceConfig config{1.0, 1, 3.0};
  const auto gains = nextBalance(config, {1.0, 1.0}, {50.0, 100.0, 200.0});
  EXPECT_NEAR(gains[0], 2.0, 1e-12);
  EXPECT_NEAR(gains[1], 0.5, 1e-12);
  EXPECT_EQ(nextBalance(config, {1.0, 1.0}, {10.0, 100.0, 1000.0}), (std::array<double, 2>{3.0, 1.0 / 3.0}));
  EXPECT_EQ(nextBalance(config, {1.5, 0.7}, {0.0, 0.0, 0.0}), (std::array<double, 2>{1.5, 0.7}));
  const auto half = nextBalance({0.5, 1, 3.0}, {1.0, 1.0}, {25.0, 100.0, 100.0});
  EXPECT_NEAR(half[0], 2.0, 1e-12);
}

TEST(Jpeg, KeepsSmoothImagesAndLosesDetailWithQuality) {
  Image image;
  image.resize(64, 48, Encoding::kRgb8);
  for (int v = 0; v < 48; ++v) {
    for (int u = 0; u < 64; ++u) {
      std::uint8_t* pixel = image.pixel(u, v);
      pixel[0] = static_cast<std::uint8_t>(3 * u);
      pixel[1] = static_cast<std::uint8_t>(5 * v);
      pixel[2] = (u / 4 + v / 4) % 2 == 0 ? 50 : 90;
    }
  }
  const auto lost = [&](Encoding encoding, int quality) {
    Image seen = image;
    seen.encoding = encoding;
    throughJpeg(quality, seen);
    double sum = 0.0;
    for (std::size_t i = 0; i < image.data.size(); ++i) sum += std::abs(int(seen.data[i]) - int(image.data[i]));
    return sum / static_cast<double>(image.data.size());
  };
  EXPECT_LT(lost(Encoding::kRgb8, 100), 4.0);
  EXPECT_GT(lost(Encoding::kRgb8, 20), 1.5 * lost(Encoding::kRgb8, 95));
  EXPECT_GT(lost(Encoding::kRgb8, 95), 0.0);
  EXPECT_NE(lost(Encoding::kRgb8, 50), lost(Encoding::kBgr8, 50));  // blue is red there
  const std::vector<std::uint8_t> bytes = jpegOf(image, 80);
  EXPECT_EQ(bytes[0], 0xff);
  EXPECT_EQ(bytes[1], 0xd8);
  EXPECT_LT(jpegOf(image, 30).size(), bytes.size());
}

}  // namespace
}  // namespace aras_visual_servo_sim::effects_test
