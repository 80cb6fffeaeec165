// Which frames a camera takes: dropped ones, and those somebody asked for.
#include <gtest/gtest.h>

#include <cmath>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "aras_visual_servo_sim/robot/urdf_loader.hpp"
#include "aras_visual_servo_sim/simulation/simulation.hpp"

namespace aras_visual_servo_sim::camera_frames_test {
namespace {

std::unique_ptr<Simulation> make(double drop_probability, bool triggered, std::uint64_t seed = 0) {
  CameraConfig camera;
  camera.name = "camera";
  camera.frame = "bob";
  camera.width = camera.height = 8;
  camera.horizontal_fov_rad = 1.0;
  camera.rate_hz = 50.0;
  camera.drop_probability = drop_probability;
  camera.triggered = triggered;
  SimulationConfig config;
  config.seed = seed;
  config.cameras = {camera};
  return std::make_unique<Simulation>(loadRobotModelFile(ARAS_SIM_TEST_DIR "/urdf/pendulum.urdf"), config,
                                      YAML::Node());
}

std::vector<std::int64_t> stampsOf(Simulation& simulation, int count) {
  std::vector<std::int64_t> stamps;
  for (int k = 0; k < count; ++k) stamps.push_back(simulation.stepToImage("camera"));
  return stamps;
}

TEST(CameraFrames, DropsAreDrawnPerFrameWithTheirProbability) {
  const auto simulation = make(0.3, false);
  constexpr int kFrames = 1000;
  const std::vector<std::int64_t> stamps = stampsOf(*simulation, kFrames);
  for (const std::int64_t stamp : stamps) EXPECT_EQ(stamp % 20000000, 0);  // the others stay at 50 Hz
  const double passed = double(stamps.back() / 20000000 + 1);
  const double dropped = double(simulation->cameras().droppedFrames());
  EXPECT_EQ(dropped, passed - kFrames);
  EXPECT_NEAR(dropped / passed, 0.3, 4.0 * std::sqrt(0.3 * 0.7 / passed));  // four standard deviations
  EXPECT_EQ(stampsOf(*make(0.3, false), kFrames), stamps);
  EXPECT_NE(stampsOf(*make(0.3, false, 1), kFrames), stamps);
}

TEST(CameraFrames, DroppedFramesAreNeverDue) {
  const auto simulation = make(0.9, false);
  const std::int64_t first = simulation->cameras()[0].nextFrameTick();
  ASSERT_GT(first, 0) << "another seed is needed for this test";
  EXPECT_FALSE(simulation->cameras()[0].frameDue(simulation->ticks()));
  EXPECT_THROW(simulation->takeFrame(0), ParameterError);
  simulation->step(first);
  EXPECT_TRUE(simulation->cameras()[0].frameDue(simulation->ticks()));
}

TEST(CameraFrames, DropsAndTriggersAreInTheSavedState) {
  const auto simulation = make(0.3, true);
  simulation->trigger(0);
  stampsOf(*simulation, 1);
  simulation->trigger(0);
  const std::string state = simulation->saveState();
  const std::vector<std::int64_t> stamps = stampsOf(*simulation, 1);
  const std::uint64_t dropped = simulation->cameras().droppedFrames();
  EXPECT_EQ(simulation->cameras()[0].nextFrameTick(), Simulation::kNever);
  simulation->restoreState(state);
  EXPECT_EQ(stampsOf(*simulation, 1), stamps);
  EXPECT_EQ(simulation->cameras().droppedFrames(), dropped);
  simulation->reset();
  EXPECT_EQ(simulation->cameras().droppedFrames(), 0u);
  EXPECT_EQ(simulation->cameras()[0].nextFrameTick(), Simulation::kNever);
}

TEST(CameraFrames, TriggeredCameraTakesOneFrameForEachRequest) {
  const auto simulation = make(0.0, true);
  EXPECT_THROW(simulation->stepToImage("camera"), ParameterError);
  simulation->step(100);
  EXPECT_FALSE(
      simulation->cameras()[0].frameDue(simulation->ticks()));  // tick 100 belongs to the schedule, but nobody asked
  simulation->trigger(0);
  simulation->trigger(0);
  EXPECT_EQ(simulation->stepToImage("camera"), 120000000);
  EXPECT_THROW(simulation->stepToImage("camera"), ParameterError);
  simulation->step(25);
  simulation->trigger(0);
  EXPECT_EQ(simulation->stepToImage("camera"), 160000000);
}

TEST(CameraFrames, ProbabilityOutOfRangeIsRefused) {
  EXPECT_THROW(make(-0.1, false), ParameterError);
  EXPECT_THROW(make(1.0, false), ParameterError);
}

}  // namespace
}  // namespace aras_visual_servo_sim::camera_frames_test
