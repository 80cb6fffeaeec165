// A sensor as a whole against the closed forms of EMVA Standard 1288.
#include "aras_visual_servo_sim/image/sensor/sensor.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "aras_visual_servo_sim/config/section.hpp"

namespace aras_visual_servo_sim::sensor_test {
namespace {

constexpr int kWidth = 200, kHeight = 150;
constexpr double kPixels = kWidth * kHeight;
constexpr double kErrors = 4.5;  // standard errors: one of the many checks fails by chance once in 10^4 seeds

SensorConfig configOf(const std::string& keys) {
  return readSection<SensorConfig>(YAML::Load("{" + keys + "}"), "", [](auto&&...) {});
}

Sensor sensorOf(const std::string& keys, Encoding encoding = Encoding::kMono8, double integration_s = 0.0,
                std::uint64_t seed = 1) {
  return {configOf(keys), kWidth, kHeight, encoding, {}, integration_s, seed, 5};
}

FineImage lightOf(const std::array<double, 3>& shares, Encoding encoding = Encoding::kMono8) {
  FineImage light;
  light.resize(kWidth, kHeight, encoding);
  for (std::size_t i = 0; i < light.data.size(); ++i) {
    light.data[i] = static_cast<std::uint16_t>(std::lround(65535.0 * shares[i % light.channels()]));
  }
  return light;
}

Image imageOf(Sensor& sensor, double share, std::uint64_t frame = 0) {
  FineImage light = lightOf({share, share, share});
  Image image;
  sensor.readOut(light, frame, true, image);
  return image;
}

double meanOf(const Image& image) {
  double sum = 0.0;
  for (const std::uint8_t x : image.data) sum += x;
  return sum / static_cast<double>(image.data.size());
}

/** Of a pixel in time, from the difference of two images: fixed patterns drop out. */
double temporalVariance(const Image& a, const Image& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.data.size(); ++i) sum += std::pow(double(a.data[i]) - b.data[i], 2);
  const double step = meanOf(a) - meanOf(b);
  return 0.5 * (sum / static_cast<double>(a.data.size()) - step * step);
}

TEST(Sensor, FollowsThePhotonTransferCurve) {
  // sigma_y^2 = K^2 (sigma_d^2 + mu_e) + 1/12 and mu_y = mu_y.dark + K mu_e.
  constexpr double kGain = 0.05, kWhite = 4000.0, kDarkNoise = 20.0, kBlack = 12.0;
  Sensor sensor = sensorOf(
      "white_photons: 8000, quantum_efficiency: 0.5, system_gain_dn_per_e: 0.05, saturation_capacity_e: 1.0e+6, "
      "dark_noise_e: 20, black_level_dn: 12");
  for (const double share : {0.0, 0.02, 0.1, 0.4, 0.8, 1.0}) {
    const Image a = imageOf(sensor, share, 0), b = imageOf(sensor, share, 1);
    const double variance = kGain * kGain * (kDarkNoise * kDarkNoise + kWhite * share) + 1.0 / 12.0;
    EXPECT_NEAR(meanOf(a), kBlack + kGain * kWhite * share, kErrors * std::sqrt(variance / kPixels)) << share;
    EXPECT_NEAR(temporalVariance(a, b), variance, kErrors * variance * std::sqrt(3.0 / kPixels)) << share;
  }
}

TEST(Sensor, WithoutNoiseIsALineThatEndsAtBothLimits) {
  Sensor sensor = sensorOf(
      "shot_noise: false, white_photons: 1000, quantum_efficiency: 1, saturation_capacity_e: 800, "
      "system_gain_dn_per_e: 0.2, black_level_dn: 30");
  for (const double share : {0.0, 0.25, 0.5, 0.79}) {
    EXPECT_EQ(imageOf(sensor, share).data[7], std::lround(30.0 + 200.0 * std::lround(65535.0 * share) / 65535.0));
  }
  EXPECT_EQ(imageOf(sensor, 0.9).data[7], 190);  // the pixel is full
  EXPECT_EQ(imageOf(sensor, 1.0).data[7], 190);
  Sensor strong = sensorOf("shot_noise: false, system_gain_dn_per_e: 1.0");
  EXPECT_EQ(imageOf(strong, 1.0).data[7], 255);  // the converter is
  Sensor fitting = sensorOf("shot_noise: false, saturation_capacity_e: 5000, quantum_efficiency: 0.25, adc_bits: 12");
  EXPECT_EQ(imageOf(fitting, 1.0).data[7], 255);  // without K a full pixel is the largest number
  EXPECT_EQ(imageOf(fitting, 0.5).data[7], 128);  // the upper 8 bits of 2048
}

TEST(Sensor, SixteenBitsHoldTheDigitalNumbersInTheirUpperBits) {
  const std::string keys = "shot_noise: false, saturation_capacity_e: 5000, quantum_efficiency: 0.25, adc_bits: 12";
  Sensor deep = sensorOf(keys, Encoding::kMono16), coarse = sensorOf(keys);
  for (const double share : {0.0, 0.1234, 0.5, 0.77, 1.0}) {
    const Image image = imageOf(deep, share);
    ASSERT_EQ(image.data.size(), 2 * kPixels);
    const int value = image.data[14] + 256 * image.data[15], number = value >> 4;
    EXPECT_EQ(value, number << 4);
    EXPECT_EQ(number, std::lround(4095.0 * std::lround(65535.0 * share) / 65535.0));
    EXPECT_EQ(upperBytes(image).data, imageOf(coarse, share).data);
  }
}

TEST(Sensor, DarkCurrentFlowsWithTimeAndIsShotNoiseToo) {
  Sensor sensor = sensorOf("dark_current_e_per_s: 5000, system_gain_dn_per_e: 0.2", Encoding::kMono8, 0.1);
  const Image a = imageOf(sensor, 0.0, 0), b = imageOf(sensor, 0.0, 1);
  const double variance = 0.04 * 500.0 + 1.0 / 12.0;
  EXPECT_NEAR(meanOf(a), 0.2 * 500.0, kErrors * std::sqrt(variance / kPixels));
  EXPECT_NEAR(temporalVariance(a, b), variance, kErrors * variance * std::sqrt(3.0 / kPixels));
}

TEST(Sensor, PatternsStayInEveryFrameAndBelongToTheSensor) {
  const std::string keys = "shot_noise: false, system_gain_dn_per_e: 0.02, black_level_dn: 20, ";
  Sensor plain = sensorOf(keys + "prnu: 0.05"), again = sensorOf(keys + "prnu: 0.05", Encoding::kMono8, 0.0, 2);
  const auto deviation = [](const Image& image) {
    const double mean = meanOf(image);
    double sum = 0.0;
    for (const std::uint8_t x : image.data) sum += std::pow(x - mean, 2);
    return std::sqrt(sum / static_cast<double>(image.data.size()));
  };
  const auto near = [](double expected) {
    return kErrors * expected / std::sqrt(2.0 * kPixels) + 1.0 / 12.0 / expected;
  };
  const Image bright = imageOf(plain, 0.8, 0);
  EXPECT_EQ(bright.data, imageOf(plain, 0.8, 1).data);
  EXPECT_EQ(bright.data, imageOf(again, 0.8, 0).data);  // another run of the same sensor
  EXPECT_NEAR(deviation(bright), 0.05 * 160.0, near(8.0));
  EXPECT_EQ(deviation(imageOf(plain, 0.0)), 0.0);
  Sensor dark = sensorOf(keys + "dsnu_e: 200");
  EXPECT_NEAR(deviation(imageOf(dark, 0.0)), 4.0, near(4.0));
  EXPECT_NEAR(deviation(imageOf(dark, 0.5)), 4.0, near(4.0));
  Sensor other(configOf(keys + "prnu: 0.05"), kWidth, kHeight, Encoding::kMono8, {}, 0.0, 1, 6);
  EXPECT_NE(bright.data, imageOf(other, 0.8, 0).data);
}

TEST(Sensor, NoiseDependsOnSeedAndFrameAlone) {
  const std::string keys = "dark_noise_e: 30";
  Sensor a = sensorOf(keys), b = sensorOf(keys), c = sensorOf(keys, Encoding::kMono8, 0.0, 2);
  imageOf(b, 0.9, 17);
  EXPECT_EQ(imageOf(a, 0.3, 4).data, imageOf(b, 0.3, 4).data);
  EXPECT_NE(imageOf(a, 0.3, 4).data, imageOf(a, 0.3, 5).data);
  EXPECT_NE(imageOf(a, 0.3, 4).data, imageOf(c, 0.3, 4).data);
}

TEST(Sensor, VignettingIsAPowerOfTheCosine) {
  std::vector<float> cosines;
  for (int i = 0; i < kWidth * kHeight; ++i) cosines.push_back(i % kWidth == 3 ? 0.8f : 1.0f);
  Sensor sensor(configOf("shot_noise: false, vignetting_exponent: 4"), kWidth, kHeight, Encoding::kMono8, cosines, 0.0,
                1, 5);
  const Image image = imageOf(sensor, 0.9);
  EXPECT_EQ(*image.pixel(2, 9), std::lround(255.0 * std::lround(65535 * 0.9) / 65535.0));
  EXPECT_EQ(*image.pixel(3, 9), std::lround(255.0 * 0.9 * std::pow(0.8, 4)));
}

TEST(Sensor, ColorsAndWhiteBalanceOfEachEncoding) {
  const std::string keys = "shot_noise: false, color_response: [0.5, 1.0, 0.25], white_balance: [2.0, 1.0, 3.0]";
  const std::array<double, 3> seen{0.8, 0.6, 0.4};
  const std::array<long, 3> bytes{204, 153, 77};  // 255 * 0.8 * 0.5 * 2; 255 * 0.6; round(255 * 0.4 * 0.25) = 26 * 3
  Image image;
  FineImage light = lightOf(seen, Encoding::kRgb8);
  sensorOf(keys, Encoding::kRgb8).readOut(light, 0, true, image);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(image.data[c], bytes[c], 1.0);
  light = lightOf({seen[2], seen[1], seen[0]}, Encoding::kBgr8);
  sensorOf(keys, Encoding::kBgr8).readOut(light, 0, true, image);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(image.data[c], bytes[2 - c], 1.0);
  light = lightOf(seen, Encoding::kRgb8);
  sensorOf(keys, Encoding::kBayerGrbg8).readOut(light, 0, true, image);
  EXPECT_NEAR(*image.pixel(0, 0), bytes[1], 1.0);
  EXPECT_NEAR(*image.pixel(1, 0), bytes[0], 1.0);
  EXPECT_NEAR(*image.pixel(0, 1), bytes[2], 1.0);
  EXPECT_NEAR(*image.pixel(1, 1), bytes[1], 1.0);
}

TEST(Sensor, AutoExposureComesSoManyFramesLateAndReachesItsLevel) {
  Sensor sensor = sensorOf("shot_noise: false, auto_exposure: {level: 0.5, speed: 1.0, delay_frames: 3, max_gain: 16}");
  std::vector<double> means;
  for (int frame = 0; frame < 9; ++frame) means.push_back(meanOf(imageOf(sensor, 0.1, frame)));
  EXPECT_EQ(means[0], std::lround(25.5));
  EXPECT_EQ(means[1], means[0]);
  EXPECT_EQ(means[2], means[0]);
  EXPECT_NEAR(means[3], 127.5, 4.0);  // a byte of 26 is off by 2 %
  EXPECT_NEAR(means[8], 127.5, 1.0);
  FineImage light = lightOf({0.1, 0.1, 0.1});
  Image image;
  const double before = sensor.state().brightness;
  sensor.readOut(light, 9, false, image);  // looked at again
  EXPECT_EQ(sensor.state().brightness, before);
}

TEST(Sensor, AutoExposureIsStoppedByItsLimitsAndGainBringsNoise) {
  Sensor sensor = sensorOf("auto_exposure: {level: 0.5, speed: 1.0, delay_frames: 1, max_gain: 4}");
  for (int frame = 0; frame < 5; ++frame) imageOf(sensor, 0.01, frame);
  EXPECT_EQ(sensor.state().brightness, 4.0);
  const Image a = imageOf(sensor, 0.01, 6), b = imageOf(sensor, 0.01, 7);
  const double gain = 4.0 * 255.0 / 10000.0, variance = gain * gain * 100.0 + 1.0 / 12.0;
  EXPECT_NEAR(meanOf(a), gain * 100.0, kErrors * std::sqrt(variance / kPixels));
  EXPECT_NEAR(temporalVariance(a, b), variance, kErrors * variance * std::sqrt(3.0 / kPixels));
  Sensor bright = sensorOf("auto_exposure: {level: 0.1, speed: 1.0, delay_frames: 1, min_exposure: 0.5}");
  for (int frame = 0; frame < 5; ++frame) imageOf(bright, 1.0, frame);
  EXPECT_EQ(bright.state().brightness, 0.5);
}

TEST(Sensor, AutoWhiteBalanceMakesGreyOfACast) {
  Sensor sensor = sensorOf(
      "shot_noise: false, adc_bits: 12, color_response: [0.5, 1.0, 0.8], "
      "auto_white_balance: {speed: 0.6, delay_frames: 2}",
      Encoding::kRgb8);
  Image image;
  for (int frame = 0; frame < 30; ++frame) {
    FineImage light = lightOf({0.5, 0.5, 0.5}, Encoding::kRgb8);
    sensor.readOut(light, frame, true, image);
    if (frame < 2) {
      EXPECT_NEAR(image.data[0], 0.5 * image.data[1], 1.0);
    }
  }
  EXPECT_NEAR(image.data[0], image.data[1], 1.0);
  EXPECT_NEAR(image.data[2], image.data[1], 1.0);
  EXPECT_NEAR(sensor.state().balance[0], 2.0, 0.01);
  EXPECT_NEAR(sensor.state().balance[1], 1.25, 0.01);
}

}  // namespace
}  // namespace aras_visual_servo_sim::sensor_test
