// The sensor of a camera in a simulation: renderers, states, and what is refused.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "tools/pan_lift.hpp"

namespace aras_visual_servo_sim::sensor_camera_test {
namespace {

Simulation with(const std::string& camera) {
  return fixture::panLift(
      "{gravity_m_s2: [0, 0, 0], cameras: [{name: camera, frame: eye_optical_frame, width: 64, height: 48, "
      "horizontal_fov_rad: 1.0, " +
      camera +
      "}], scene: {background_rgb: [60, 120, 90], models: [{name: target, color_rgb: [20, 20, 20], "
      "outlines_m: [[[-0.1, -0.05], [0.1, -0.05], [0.1, 0.05], [-0.1, 0.05]]], "
      "motion: {type: constant_velocity, linear_m_per_s: [0.5, 0.2, 0.0]}}]}}");
}

const char* const kAutomatic =
    "sensor: {dark_noise_e: 10, auto_exposure: {delay_frames: 3}, auto_white_balance: {delay_frames: 2}}";

TEST(SensorCamera, WithoutNoiseShowsWhatTheSceneDoes) {
  for (const char* encoding : {"rgb8", "bgr8", "mono8"}) {
    const std::string keys = std::string("encoding: ") + encoding;
    Simulation plain = with(keys), sensed = with(keys + ", sensor: {shot_noise: false}");
    const Image& seen = plain.render(0);
    const Image& image = sensed.render(0);
    ASSERT_EQ(image.data.size(), seen.data.size());
    for (std::size_t i = 0; i < image.data.size(); ++i) ASSERT_NEAR(image.data[i], seen.data[i], 1) << encoding;
  }
}

TEST(SensorCamera, BayerImageIsTheMosaicOfTheColors) {
  Simulation color = with("encoding: rgb8");
  const Image seen = color.render(0);
  for (const char* more : {"", ", sensor: {shot_noise: false}"}) {
    Simulation bayer = with(std::string("encoding: bayer_rggb8") + more);
    const Image& mosaic = bayer.render(0);
    ASSERT_EQ(mosaic.channels(), 1);
    for (int v = 0; v < 48; ++v) {
      for (int u = 0; u < 64; ++u) ASSERT_NEAR(*mosaic.pixel(u, v), seen.pixel(u, v)[u % 2 + v % 2], 1);
    }
  }
}

TEST(SensorCamera, WhatTheCameraSetsIsInTheSavedStateAndGoneAfterAReset) {
  Simulation simulation = with(kAutomatic), other = with(kAutomatic);
  const std::string fresh = fixture::hashOf(simulation, 8);
  EXPECT_NE(simulation.cameras()[0].sensor()->state().brightness, 1.0);
  const std::string state = simulation.saveState();
  const std::string hash = fixture::hashOf(simulation, 5);
  simulation.restoreState(state);
  EXPECT_EQ(fixture::hashOf(simulation, 5), hash);
  other.restoreState(state);
  EXPECT_EQ(fixture::hashOf(other, 5), hash);
  simulation.reset();
  EXPECT_EQ(fixture::hashOf(simulation, 8), fresh);
}

TEST(SensorCamera, LookingTwiceAtAFrameChangesNothing) {
  Simulation once = with(kAutomatic), twice = with(kAutomatic);
  for (int k = 0; k < 5; ++k) {
    once.stepToImage("camera");
    once.render(0);
    twice.stepToImage("camera");
    const std::vector<std::uint8_t> first = twice.render(0).data;
    EXPECT_EQ(twice.render(0).data, first);
  }
  EXPECT_EQ(once.runHash(), twice.runHash());
}

TEST(SensorCamera, OutOfRangeIsNamed) {
  struct Case {
    const char *keys, *named;
  };
  for (const Case& each : {Case{"sensor: {quantum_efficiency: 1.5}", "quantum_efficiency"},
                           {"sensor: {adc_bits: 17}", "adc_bits"},
                           {"sensor: {white_photons: 0}", "white_photons"},
                           {"sensor: {prnu: -0.1}", "prnu"},
                           {"sensor: {dark_noise_e: .nan}", "dark_noise_e"},
                           {"sensor: {no_such_key: 1}", "no_such_key"},
                           {"sensor: {color_response: [1, 1]}", "color_response"},
                           {"sensor: {black_level_dn: 255}", "black_level_dn"},
                           {"sensor: {row_time_s: 0.001}", "row_time_s"},
                           {"sensor: {jpeg_quality: 101}", "jpeg_quality"},
                           {"sensor: {auto_exposure: {delay_frames: 0}}", "delay_frames"},
                           {"sensor: {auto_white_balance: {}}, encoding: mono8", "auto_white_balance"},
                           {"sensor: {}, noise_stddev: 1.0", "noise_stddev"},
                           {"sensor: {auto_white_balance: {}}, encoding: mono16", "auto_white_balance"},
                           {"sensor: {jpeg_quality: 80}, encoding: rgb16", "jpeg_quality"},
                           {"encoding: bayer_rgbg8", "encoding"},
                           {"sensor: 3", "sensor"}}) {
    const std::string keys = each.keys;
    try {
      with(keys);
      ADD_FAILURE() << keys << " was accepted";
    } catch (const ParameterError& error) {
      EXPECT_NE(std::string(error.what()).find(each.named), std::string::npos) << error.what();
      EXPECT_NE(std::string(error.what()).find("allowed"), std::string::npos) << error.what();
    }
  }
}

}  // namespace
}  // namespace aras_visual_servo_sim::sensor_camera_test
