// What is done again and again allocates nothing once it has been done: no jitter, and memory that does not grow.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "../allocations.hpp"
#include "fixture.hpp"

namespace aras_visual_servo_sim {
namespace {

constexpr int kWarmUp = 200;  // steps: set-points, stops and friction have been met

/** The arm with a PID on each joint, moving. */
std::unique_ptr<MultibodyWorld> movingArm() {
  WorldConfig config;
  const RobotModel model = loadRobotModelFile(ARAS_SIM_TEST_DIR "/urdf/six_joint_arm.urdf");
  for (const std::string& joint : model.joint_names) {
    ControllerConfig controller;
    controller.name = controller.joint = joint;
    controller.gains = PidGains{2000.0, 50.0, 100.0, -100.0, 100.0, false};
    config.controllers.push_back(controller);
  }
  return std::make_unique<MultibodyWorld>(model, config);
}

TEST(Allocation, TheCounterCounts) {
  EXPECT_GT(allocationsOf([] { std::make_unique<std::string>(100, 'x'); }), 1u);
  EXPECT_GT(allocationsOf([] { Eigen::VectorXd::Zero(100).eval(); }), 0u);
  EXPECT_EQ(allocationsOf([] {}), 0u);
}

TEST(Allocation, APhysicsStepMakesNone) {
  const auto arm = movingArm();
  MultibodyWorld& world = *arm;
  JointCommand command;
  for (const std::string& joint : world.model().joint_names) command.position[joint] = 0.3;
  world.setCommand(command);
  world.step(kWarmUp);
  EXPECT_EQ(allocationsOf([&] { world.step(1000); }), 0u);
}

TEST(Allocation, ASimulationsStepMakesNoneBetweenFrames) {
  Simulation simulation = fixture::panLift();
  simulation.stepToImage("camera");
  simulation.step(1);
  EXPECT_EQ(allocationsOf([&] { simulation.step(10); }), 0u);
}

}  // namespace
}  // namespace aras_visual_servo_sim
