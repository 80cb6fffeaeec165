#include "aras_visual_servo_sim/simulation/simulation.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "tools/pan_lift.hpp"

namespace aras_visual_servo_sim::simulation_test {
namespace {

constexpr int kCamera = 0;
const double kNan = std::numeric_limits<double>::quiet_NaN();
// Lift of the fixture: m g / p, what its weight takes from the proportional term before the integral has made up for
// it.
constexpr double kSagM = 1.2 * 9.81 / 2000.0;

JointCommand position(const std::string& joint, double value) { return {{{joint, value}}, {}, {}}; }
JointCommand velocity(const std::string& joint, double value) { return {{}, {{joint, value}}, {}}; }

std::string runAndHash(Simulation& simulation, int frames) {
  for (int k = 0; k < frames; ++k) {
    simulation.stepToImage("camera");
    simulation.render(kCamera);
    simulation.setCommand(velocity("pan", 0.2), simulation.timeNs());
  }
  return simulation.runHash();
}

TEST(Simulation, FirstImageIsAtTickZeroAndFollowingOnesAtTheirTicks) {
  Simulation simulation = fixture::panLift();
  EXPECT_EQ(simulation.stepToImage("camera"), 0);
  EXPECT_EQ(simulation.stepToImage("camera"), 34000000);
  EXPECT_EQ(simulation.stepToImage("camera"), 67000000);
}

TEST(Simulation, SteppingPastAFrameMissesIt) {
  Simulation simulation = fixture::panLift();
  simulation.step(40);
  EXPECT_EQ(simulation.stepToImage("camera"), 67000000);
}

TEST(Simulation, TwoCamerasKeepTheirOwnRates) {
  Simulation simulation = fixture::panLift(
      "cameras: [{name: slow, frame: head, width: 8, height: 8, horizontal_fov_rad: 1.0, rate_hz: 10.0},"
      " {name: fast, frame: eye_optical_frame, width: 8, height: 8, horizontal_fov_rad: 1.0, rate_hz: 100.0}]");
  simulation.stepToImage("slow");
  EXPECT_EQ(simulation.stepToImage("fast"), 0);
  EXPECT_EQ(simulation.stepToImage("fast"), 10000000);
  EXPECT_EQ(simulation.stepToImage("slow"), 100000000);
  EXPECT_TRUE(simulation.cameras()[simulation.cameras().index("fast")].frameDue(simulation.ticks()));
}

TEST(Simulation, SameCallsGiveTheSameHashAndResetGivesItAgain) {
  Simulation first = fixture::panLift();
  Simulation second = fixture::panLift();
  const std::string hash = runAndHash(first, 5);
  EXPECT_EQ(runAndHash(second, 5), hash);
  first.setModelPose("target", Pose{Eigen::Vector3d(0.1, 0.0, 0.0), Eigen::Quaterniond::Identity()});
  first.reset();
  EXPECT_EQ(runAndHash(first, 5), hash);
}

TEST(Simulation, HashSeesJointsAndImages) {
  Simulation plain = fixture::panLift();
  const std::string hash = runAndHash(plain, 3);
  Simulation moved = fixture::panLift();
  moved.setModelPose("target", Pose{Eigen::Vector3d(0.05, 0.0, 0.0), Eigen::Quaterniond::Identity()});
  EXPECT_NE(runAndHash(moved, 3), hash);
  Simulation elsewhere = fixture::panLift("initial_positions: {pan: 0.01}");
  EXPECT_NE(runAndHash(elsewhere, 3), hash);
}

TEST(Simulation, RestoredStateContinuesAsTheOriginalDid) {
  Simulation simulation = fixture::panLift();
  runAndHash(simulation, 3);
  const std::string state = simulation.saveState();
  const std::string hash = runAndHash(simulation, 4);
  simulation.restoreState(state);
  EXPECT_EQ(simulation.ticks(), 67);
  EXPECT_EQ(runAndHash(simulation, 4), hash);
}

TEST(Simulation, DamagedStateIsRefusedAndChangesNothing) {
  Simulation simulation = fixture::panLift();
  simulation.step(10);
  const std::string state = simulation.saveState();
  simulation.step(10);
  EXPECT_THROW(simulation.restoreState(state.substr(0, state.size() - 1)), StateError);
  EXPECT_THROW(simulation.restoreState(state + "x"), StateError);
  EXPECT_THROW(simulation.restoreState(""), StateError);
  std::string flipped = state;
  flipped[flipped.size() / 2] ^= 1;
  EXPECT_THROW(simulation.restoreState(flipped), StateError);
  EXPECT_EQ(simulation.ticks(), 20);
}

TEST(Simulation, NoiseOfAFrameDoesNotDependOnWhatWasRenderedBefore) {
  const std::string noisy =
      "cameras: [{name: camera, frame: eye_optical_frame, width: 16, height: 16, horizontal_fov_rad: 1.0,"
      " rate_hz: 30.0, noise_stddev: 5.0}]";
  Simulation every = fixture::panLift(noisy);
  Simulation last = fixture::panLift(noisy);
  for (int k = 0; k < 3; ++k) {
    every.stepToImage("camera");
    every.render(kCamera);
    last.stepToImage("camera");
  }
  EXPECT_EQ(every.render(kCamera).data, last.render(kCamera).data);
}

TEST(Simulation, NonFiniteCommandIsRefusedCountedAndTheArmHolds) {
  Simulation simulation = fixture::panLift();
  simulation.setCommand(velocity("pan", 0.5));
  simulation.step(50);
  EXPECT_THROW(simulation.setCommand(velocity("pan", kNan)), NotFiniteError);
  EXPECT_EQ(simulation.commands().refused(), 1U);
  EXPECT_NE(simulation.commands().lastRefusal().find("pan"), std::string::npos);
  const double set_point = simulation.body().controllerState("pan_controller").set_point;
  simulation.step(50);
  EXPECT_EQ(simulation.body().controllerState("pan_controller").set_point, set_point);
}

TEST(Simulation, VelocityCommandStopsActingAfterItsTimeout) {
  Simulation simulation = fixture::panLift("command_timeout_s: 0.1");
  simulation.setCommand(velocity("pan", 0.5));
  simulation.step(1000);
  // 0.1 s at 0.5 rad/s; one period more or less decides what the last step counts
  EXPECT_NEAR(simulation.body().controllerState("pan_controller").set_point, 0.05, 0.5 * 0.001 + 1e-12);
}

TEST(Simulation, CommandedPositionIsReachedAndSeenByTheCamera) {
  Simulation simulation = fixture::panLift();
  simulation.setCommand(position("lift", 0.1));
  simulation.step(2000);
  EXPECT_NEAR(simulation.cameraPose(kCamera).p.z(), 0.6, kSagM);
}

TEST(Simulation, UnknownFrameOfACameraIsNamed) {
  try {
    fixture::panLift("cameras: [{name: a, frame: nowhere, width: 8, height: 8, horizontal_fov_rad: 1.0}]");
    FAIL() << "accepted";
  } catch (const ParameterError& error) {
    EXPECT_NE(std::string(error.what()).find("nowhere"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace aras_visual_servo_sim::simulation_test
