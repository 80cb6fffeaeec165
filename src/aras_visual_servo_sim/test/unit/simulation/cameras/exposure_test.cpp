// Motion blur: which moments an image is the mean of, and what an edge in motion looks like.
#include "aras_visual_servo_sim/simulation/cameras/exposure.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "tools/pan_lift.hpp"

namespace aras_visual_servo_sim::exposure_test {
namespace {

constexpr std::int64_t kMillisecond = 1000000;
constexpr int kFrameTick = 34;                           // of frame 1 at 30 Hz and 1 ms
const std::vector<int> kSampleTicks = {17, 22, 27, 32};  // 34 - 17.5, - 12.5 ..., of two equally near ones the later

/** Target in straight motion below the pan-lift robot; `camera` is added to the camera's keys. */
Simulation moving(const std::string& camera, const std::string& motion_m_per_s = "[0.5, 0.2, 0.0]") {
  return fixture::panLift(
      "{gravity_m_s2: [0, 0, 0], cameras: [{name: camera, frame: eye_optical_frame, width: 64, height: 48, "
      "horizontal_fov_rad: 1.0" +
      camera +
      "}], scene: {models: [{name: target, color_rgb: [20, 20, 20], "
      "outlines_m: [[[-0.1, -0.05], [0.1, -0.05], [0.1, 0.05], [-0.1, 0.05]]], "
      "motion: {type: constant_velocity, linear_m_per_s: " +
      motion_m_per_s + "}}]}}");
}

const char* const kBlur = ", exposure_s: 0.02, exposure_samples: 4";

/** Frame 1 while the camera pans. */
std::vector<std::uint8_t> frameOne(Simulation& simulation) {
  simulation.setControllerCommand("pan_controller", 1.0);
  simulation.step(kFrameTick);
  return simulation.render(0).data;
}

TEST(Exposure, SamplesAreTheTicksNearestToTheMiddlesOfItsParts) {
  const Exposure exposure(0.02, 4, kMillisecond);
  std::vector<int> ticks;
  for (int tick = 0; tick <= kFrameTick; ++tick) {
    if (exposure.samples(tick, kFrameTick)) ticks.push_back(tick);
  }
  EXPECT_EQ(ticks, kSampleTicks);
  EXPECT_EQ(exposure.nextSample(0, kFrameTick), 17);
  EXPECT_EQ(exposure.nextSample(17, kFrameTick), 22);
  EXPECT_EQ(exposure.nextSample(32, kFrameTick), kFrameTick);
  EXPECT_FALSE(Exposure(0.0, 4, kMillisecond).blurs());
}

TEST(Exposure, EdgeInMotionIsTheRampOfItsMeanOverTheExposure) {
  constexpr double kSpeed = 0.5, kExposure = 0.04, kTime = 0.05, kDepth = 0.5, kDark = 20.0, kBright = 230.0;
  constexpr int kSamples = 20, kWidth = 320, kRow = 3;
  Simulation simulation = fixture::panLift(
      "{gravity_m_s2: [0, 0, 0], cameras: [{name: camera, frame: eye_optical_frame, width: 320, height: 7, "
      "encoding: mono8, horizontal_fov_rad: 1.0, rate_hz: 20.0, exposure_s: 0.04, exposure_samples: 20}], "
      "scene: {background_rgb: [230, 230, 230], models: [{name: target, color_rgb: [20, 20, 20], "
      "outlines_m: [[[-0.2, -0.1], [0.1, -0.1], [0.1, 0.1], [-0.2, 0.1]]], "
      "motion: {type: constant_velocity, linear_m_per_s: [0.5, 0.0, 0.0]}}]}}");
  simulation.stepToImage("camera");
  ASSERT_EQ(simulation.stepToImage("camera"), 50 * kMillisecond);
  const Image& image = simulation.render(0);
  const CameraModel& camera = simulation.cameras()[0].model();
  const double end_u = camera.cx() + camera.fx() * (0.1 + kSpeed * kTime) / kDepth;  // of the edge, when the stamp is
  const double ramp = kSpeed * kExposure * camera.fx() / kDepth;
  ASSERT_GT(ramp, 10.0);
  // The edge jumps by ramp / N instead of gliding: half a jump off at most. Samples and mean are rounded, half a level
  // each.
  const double tolerance = (kBright - kDark) / (2.0 * kSamples) + 1.0;
  double dark = 0.0, expected_dark = 0.0;
  for (int u = kWidth / 2; u < kWidth; ++u) {
    constexpr int kFine = 1000;
    double covered = 0.0;  // mean over the pixel of the part of the exposure in which the target was there
    for (int k = 0; k < kFine; ++k) {
      covered += std::clamp((end_u - (u - 0.5 + (k + 0.5) / kFine)) / ramp, 0.0, 1.0) / kFine;
    }
    const double expected = kBright + (kDark - kBright) * covered;
    EXPECT_NEAR(*image.pixel(u, kRow), expected, tolerance) << "u " << u;
    dark += (kBright - *image.pixel(u, kRow)) / (kBright - kDark);
    expected_dark += covered;
  }
  // Where the middle of the ramp is: the middles of equal parts have the mean of the whole. Rounding: 1 level a pixel.
  EXPECT_NEAR(dark, expected_dark, (ramp + 2.0) / (kBright - kDark));
}

TEST(Exposure, ImageIsTheMeanOfSharpOnesRoundedOnce) {
  Simulation sharp = moving(""), blurred = moving(kBlur);
  sharp.setControllerCommand("pan_controller", 1.0);
  std::vector<std::uint32_t> sums;
  for (const int tick : kSampleTicks) {
    sharp.step(tick - sharp.ticks());
    const std::vector<std::uint8_t>& data = sharp.render(0).data;
    sums.resize(data.size());
    for (std::size_t i = 0; i < data.size(); ++i) sums[i] += data[i];
  }
  std::vector<std::uint8_t> mean;
  for (const std::uint32_t sum : sums) mean.push_back(static_cast<std::uint8_t>((sum + 2) / 4));
  EXPECT_EQ(frameOne(blurred), mean);
  sharp.step(kFrameTick - sharp.ticks());
  EXPECT_NE(sharp.render(0).data, mean);
  EXPECT_EQ(blurred.body().jointPositions(), sharp.body().jointPositions());
  EXPECT_EQ(blurred.cameraPose(0).matrix(), sharp.cameraPose(0).matrix());
  EXPECT_EQ(blurred.models().pose("target").matrix(), sharp.models().pose("target").matrix());

  Simulation noisy = moving(std::string(kBlur) + ", noise_stddev: 1.0");
  double sum = 0.0, expected = 0.0;
  for (const std::uint8_t x : frameOne(noisy)) sum += x;
  for (const std::uint32_t x : sums) expected += x / 4.0;
  const double values = static_cast<double>(mean.size());
  EXPECT_NEAR(sum / values, expected / values, 4.0 * std::sqrt((1.0 + 1.0 / 12.0) / values));  // four standard errors
}

TEST(Exposure, DitherIsNoiseOfHalfAGreyLevelUnlessThereIsMore) {
  const auto image = [](const std::string& keys) {
    Simulation simulation = moving(kBlur + keys);
    return frameOne(simulation);
  };
  EXPECT_EQ(image(", dither: true"), image(", noise_stddev: 0.5"));
  EXPECT_EQ(image(", dither: true, noise_stddev: 2.0"), image(", noise_stddev: 2.0"));
  EXPECT_NE(image(", dither: true"), image(""));
}

TEST(Exposure, NothingThatMovesNoPastOrNoFrameIsSharp) {
  Simulation sharp = moving(""), blurred = moving(kBlur);
  EXPECT_EQ(blurred.render(0).data, sharp.render(0).data);  // t = 0
  sharp.step(30);
  blurred.step(30);
  EXPECT_EQ(blurred.render(0).data, sharp.render(0).data);  // between frames
  Simulation sharp_still = moving("", "[0, 0, 0]"), still = moving(kBlur, "[0, 0, 0]");
  EXPECT_EQ(fixture::hashOf(still, 4), fixture::hashOf(sharp_still, 4));
}

TEST(Exposure, BeginsAnewWhereSomethingIsPlaced) {
  const Pose there{{0.05, 0.0, 0.0}, Eigen::Quaterniond::Identity()};
  const YAML::Node box = YAML::Load("{name: box, box_m: [0.05, 0.05, 0.05], position_m: [0.1, 0, 0.1]}");
  const std::vector<std::function<void(Simulation&)>> jumps = {
      [&](Simulation& simulation) { simulation.setModelPose("target", there); },
      [&](Simulation& simulation) {
        simulation.setJointPositions({{"pan", 0.3}});
      },
      [&](Simulation& simulation) { simulation.spawnModel(box); },
      [&](Simulation& simulation) { simulation.deleteModel("target"); },
      [&](Simulation& simulation) { simulation.resetWorld(); }};
  for (std::size_t k = 0; k < jumps.size(); ++k) {
    Simulation sharp = moving(""), blurred = moving(kBlur);
    for (Simulation* each : {&sharp, &blurred}) {
      each->step(kFrameTick);
      jumps[k](*each);
    }
    EXPECT_EQ(blurred.render(0).data, sharp.render(0).data) << "jump " << k;
  }
}

TEST(Exposure, SavedStateHoldsWhatIsExposed) {
  for (const int tick : {20, kFrameTick}) {
    Simulation simulation = moving(kBlur), other = moving(kBlur);
    simulation.setControllerCommand("pan_controller", 1.0);
    simulation.step(tick);
    const std::string state = simulation.saveState();
    const std::string hash = fixture::hashOf(simulation, 3);
    simulation.restoreState(state);
    EXPECT_EQ(fixture::hashOf(simulation, 3), hash) << "tick " << tick;
    other.restoreState(state);
    EXPECT_EQ(fixture::hashOf(other, 3), hash) << "tick " << tick;
    Simulation sharp = moving("");
    EXPECT_THROW(sharp.restoreState(state), StateError);
    EXPECT_THROW(simulation.restoreState(sharp.saveState()), StateError);
  }
}

TEST(Exposure, SameBytesHoweverItIsSteppedAndAfterAReset) {
  Simulation once = moving(kBlur), again = moving(kBlur);
  const std::string hash = fixture::hashOf(once, 4);
  for (int k = 0; k < 4; ++k) {
    while (!again.cameras()[0].frameDue(again.ticks())) again.step(1);
    again.takeFrame(0);
    again.render(0);
  }
  EXPECT_EQ(again.runHash(), hash);
  once.reset();
  EXPECT_EQ(fixture::hashOf(once, 4), hash);
}

TEST(Exposure, TriggerInTheMiddleOfItGetsTheWholeOfIt) {
  Simulation free = moving(kBlur), triggered = moving(std::string(kBlur) + ", triggered: true");
  const std::vector<std::uint8_t> expected = frameOne(free);
  triggered.setControllerCommand("pan_controller", 1.0);
  triggered.step(25);
  triggered.trigger(0);
  EXPECT_EQ(triggered.stepToImage("camera"), kFrameTick * kMillisecond);
  EXPECT_EQ(triggered.render(0).data, expected);
}

TEST(Exposure, OutOfRangeIsRefused) {
  for (const char* keys : {"exposure_s: -0.001", "exposure_s: 0.0334", "exposure_s: .nan", "exposure_samples: 0",
                           "exposure_samples: 257"}) {
    try {
      moving(std::string(", ") + keys);
      ADD_FAILURE() << keys << " was accepted";
    } catch (const ParameterError& error) {
      const std::string key = std::string(keys).substr(0, std::string(keys).find(':'));
      EXPECT_NE(std::string(error.what()).find(key), std::string::npos) << error.what();
    }
  }
}

}  // namespace
}  // namespace aras_visual_servo_sim::exposure_test
