#include "aras_visual_servo_sim/config/section.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "aras_visual_servo_sim/camera/camera_config.hpp"
#include "aras_visual_servo_sim/config/errors.hpp"
#include "aras_visual_servo_sim/scene/scene.hpp"
#include "aras_visual_servo_sim/simulation/simulation_config.hpp"

namespace aras_visual_servo_sim::section_test {
namespace {

TEST(Sections, EachCanBeLoaded) {
  EXPECT_GE(schemaSections().names().size(), 15u);
  for (const std::string& name : schemaSections().names()) EXPECT_NO_THROW(sectionOf(name)) << name;
}

TEST(Sections, WhatIsMadeWithoutYamlIsWhatEmptySectionsGive) {
  const SimulationConfig made, read = SimulationConfig::fromYaml(YAML::Node());
  EXPECT_EQ(made.world.period_s, read.world.period_s);
  EXPECT_EQ(made.world.gravity_m_s2, read.world.gravity_m_s2);
  EXPECT_EQ(made.world.drive, read.world.drive);
  EXPECT_EQ(made.world.base, read.world.base);
  EXPECT_EQ(made.seed, read.seed);
  EXPECT_EQ(made.gazebo_cameras, read.gazebo_cameras);
  EXPECT_EQ(made.world.contacts.friction, read.world.contacts.friction);
  EXPECT_EQ(made.world.contacts.stiffness_n_per_m, read.world.contacts.stiffness_n_per_m);
  EXPECT_EQ(made.world.contacts.damping_n_s_per_m, read.world.contacts.damping_n_s_per_m);
  EXPECT_EQ(made.world.contacts.any(), read.world.contacts.any());
  EXPECT_TRUE(Scene().background == read.scene.background);
  EXPECT_EQ(Scene().light_direction_W, read.scene.light_direction_W);

  CameraConfig camera;
  const auto camera_read = readSection<CameraKeys>(
      YAML::Load("{name: c, frame: f, width: 4, height: 3, horizontal_fov_rad: 1.0}"), "", [](auto&&...) {});
  EXPECT_EQ(camera.rate_hz, camera_read.rate_hz);
  EXPECT_EQ(camera.encoding, camera_read.encoding);
  EXPECT_EQ(camera.distortion_model, camera_read.distortion_model);
  EXPECT_EQ(camera.near_m, camera_read.near_m);
  EXPECT_EQ(camera.far_m, camera_read.far_m);
  EXPECT_EQ(camera.exposure_samples, camera_read.exposure_samples);
  EXPECT_GT(camera.rate_hz * camera.near_m * camera.far_m * camera.exposure_samples, 0.0);
}

TEST(Sections, AValueFromElsewhereIsCheckedAsOneOfYaml) {
  FaultList faults;
  checkValue(sectionOf("camera"), "latency_s", 0.5, faults);
  checkValue(sectionOf("camera"), "encoding", std::string("mono8"), faults);
  EXPECT_TRUE(faults.empty());
  checkValue(sectionOf("camera"), "latency_s", 11.0, faults);
  checkValue(sectionOf("camera"), "rate_hz", std::numeric_limits<double>::infinity(), faults);
  checkValue(sectionOf("camera"), "width", 0, faults);
  checkValue(sectionOf("camera"), "encoding", std::string("rgba8"), faults);
  checkValue(sectionOf("sim"), "gravity_m_s2", std::vector<double>{0.0, 1.0}, faults);
  EXPECT_EQ(faults.lines(),
            (std::vector<std::string>{"latency_s: found 11, allowed >= 0 and <= 10",
                                      "rate_hz: found .inf, allowed >= 1e-06 and <= 1000000",
                                      "width: found 0, allowed >= 1 and <= 16384",
                                      "encoding: found rgba8, allowed one of rgb8, bgr8, mono8, rgb16, mono16, "
                                      "bayer_rggb8, bayer_bggr8, bayer_gbrg8, bayer_grbg8; did you mean rgb8?",
                                      "gravity_m_s2: found [0, 1], allowed a list of 3 numbers"}));
}

}  // namespace
}  // namespace aras_visual_servo_sim::section_test
