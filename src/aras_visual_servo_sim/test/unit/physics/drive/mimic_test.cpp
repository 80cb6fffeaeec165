#include "aras_visual_servo_sim/config/errors.hpp"
#include "tools/physics_tools.hpp"

namespace aras_visual_servo_sim::mimic_test {
namespace {

constexpr double kEps = 2.2e-16;

std::string gripper() { return readUrdf("mimic_gripper.urdf"); }

std::string withoutFriction(std::string urdf) {
  urdf = replaced(urdf, "damping=\"0.5\" friction=\"0.2\"", "damping=\"0\"");
  return replaced(urdf, "damping=\"0.4\" friction=\"0.1\"", "damping=\"0\"");
}

/** joint_names order: left, right, tip, wrist. */
Eigen::VectorXd start() { return vectorOf({0.05, 0.0, -0.05, 0.4}); }

TEST(Mimic, FollowersAreWhereTheirChainsPutThemAtEveryStep) {
  MultibodyWorld world(modelOf(gripper()), WorldConfig{});
  world.reset(start());
  for (int k = 0; k < 300; ++k) {
    world.step();
    const Eigen::VectorXd& q = world.jointPositions();
    const Eigen::VectorXd& v = world.jointVelocities();
    ASSERT_EQ(q[1], -2.0 * q[0] + 0.1);
    ASSERT_NEAR(q[2], 3.0 * q[1] - 0.05, 4 * kEps);
    ASSERT_EQ(v[1], -2.0 * v[0]);
    ASSERT_EQ(v[2], -6.0 * v[0]);
  }
  EXPECT_NE(world.jointVelocities()[0], 0.0);
}

TEST(Mimic, ItsInertiaActsThroughTheSquareOfItsMultiplier) {
  std::string urdf = replaced(withoutFriction(gripper()), "type=\"continuous\"", "type=\"fixed\"");
  urdf = replaced(urdf, "<joint name=\"tip\" type=\"revolute\">", "<joint name=\"tip\" type=\"fixed\">");
  WorldConfig config = weightless();
  config.controllers = {controllerOf("left", ControllerType::kEffort)};
  MultibodyWorld world(modelOf(urdf), config);
  world.setEffort("left", 1.5);
  world.step();
  const double mass = 0.3 + 4.0 * (0.2 + 0.05);
  EXPECT_NEAR(world.jointVelocities()[0], 0.001 * 1.5 / mass, 1e-3 * 1.5 / mass * 100 * kEps);
  EXPECT_EQ(world.jointEfforts()[0], 1.5);
  EXPECT_EQ(world.jointEfforts()[1], 0.0);
}

TEST(Mimic, ItsFrictionActsThroughItsMultiplier) {
  std::string urdf = replaced(gripper(), "type=\"continuous\"", "type=\"fixed\"");
  WorldConfig config = weightless();
  config.controllers = {controllerOf("left", ControllerType::kEffort)};
  MultibodyWorld world(modelOf(urdf), config);
  const double breakaway = 0.2 + 2.0 * 0.1;
  world.setEffort("left", breakaway - 1e-9);
  world.step(10);
  EXPECT_EQ(world.jointVelocities()[0], 0.0);
  world.setEffort("left", breakaway + 1e-6);
  world.step(10);
  EXPECT_GT(world.jointVelocities()[0], 0.0);
}

TEST(Mimic, ItsStribeckFrictionActsThroughItsMultiplier) {
  std::string urdf = replaced(gripper(), "type=\"continuous\"", "type=\"fixed\"");
  urdf = replaced(urdf, "<joint name=\"tip\" type=\"revolute\">", "<joint name=\"tip\" type=\"fixed\">");
  urdf = replaced(urdf, "damping=\"0.4\" friction=\"0.1\"",
                  "damping=\"0\" friction=\"0.1\" static_friction=\"0.4\" stribeck_velocity=\"0.5\"");
  WorldConfig config = weightless();
  config.controllers = {controllerOf("left", ControllerType::kVelocity)};
  MultibodyWorld world(modelOf(urdf), config);
  world.setVelocity("left", 0.15);
  world.step(20);  // the right finger has -0.3 m/s
  const double right = 0.1 + 0.3 * std::exp(-0.3 * 0.3 / 0.25);
  EXPECT_NEAR(world.jointEfforts()[0], 0.2 + 0.5 * 0.15 + 2.0 * right, 1e-12);
}

/** Energy lost in a second of swinging without friction. */
double energyError(double period_s) {
  WorldConfig config;
  config.period_s = period_s;
  std::string urdf = replaced(withoutFriction(gripper()), "lower=\"-0.2\" upper=\"0.3\"", "lower=\"-90\" upper=\"90\"");
  urdf = replaced(urdf, "lower=\"-0.4\" upper=\"0.1\"", "lower=\"-90\" upper=\"90\"");
  urdf = replaced(urdf, "lower=\"-3\" upper=\"3\"", "lower=\"-90\" upper=\"90\"");
  MultibodyWorld world(modelOf(urdf), config);
  world.reset(start());
  const double before = world.energy();
  world.step(static_cast<int>(std::lround(0.4 / period_s)));
  return world.energy() - before;
}

TEST(Mimic, ConservesEnergyToFirstOrderInThePeriod) {
  const double coarse = energyError(2e-4);
  const double fine = energyError(1e-4);
  EXPECT_GT(std::abs(coarse), 1e-6);      // there is motion to lose it in
  EXPECT_NEAR(fine / coarse, 0.5, 0.05);  // first order, the second one left over
}

TEST(Mimic, ItsLimitsBoundWhatItFollows) {
  const RobotModel model = modelOf(gripper());
  const JointLimits& left = model.movingJoint(0).limits;
  // right in [-0.4, 0.1] is left in [0, 0.25]; tip in [-3, 3] binds nothing; velocities 2 / 2 and 10 / 6.
  EXPECT_NEAR(left.lower, 0.0, kEps);
  EXPECT_NEAR(left.upper, 0.25, kEps);
  EXPECT_EQ(left.velocity, 1.0);
  WorldConfig config = weightless();
  config.controllers = {controllerOf("left", ControllerType::kEffort)};
  MultibodyWorld world(model, config);
  world.setEffort("left", 20.0);
  world.step(2000);
  EXPECT_EQ(world.jointPositions()[0], left.upper);
}

TEST(Mimic, IsMovedOnlyThroughWhatItFollows) {
  WorldConfig config = weightless();
  config.controllers = {controllerOf("left", ControllerType::kEffortPosition, PidGains{100, 0, 10, 0, 0, false})};
  MultibodyWorld world(modelOf(gripper()), config);
  EXPECT_HAS(messageOf<ParameterError>([&] { world.setPosition("tip", 0.1); }),
             "joint 'tip': mimics 'left', must be moved through that joint");
  EXPECT_HAS(messageOf<ParameterError>([&] {
               world.setJointPositions({{"left", 0.1}, {"right", 0.1}});
             }),
             "joint 'right': position is 0.1, must be -0.1 (it mimics 'left') or left out");
  world.setJointPositions({{"left", 0.1}, {"right", -0.1}});
  EXPECT_EQ(world.jointPositions()[1], -0.1);
  config.controllers = {controllerOf("right", ControllerType::kEffort)};
  EXPECT_HAS(messageOf<ParameterError>([&] { MultibodyWorld(modelOf(gripper()), config); }), "joint 'right': mimics");
}

TEST(Mimic, WhatCannotBeFollowedIsRefused) {
  const auto refusal = [&](const std::string& from, const std::string& to) {
    return messageOf<ModelError>([&] { modelOf(replaced(gripper(), from, to)); });
  };
  EXPECT_HAS(refusal("<mimic joint=\"left\"", "<mimic joint=\"nobody\""), "joint 'right': mimics joint 'nobody'");
  EXPECT_HAS(refusal("<mimic joint=\"left\"", "<mimic joint=\"tip\""), "found a loop of <mimic>");
  EXPECT_HAS(refusal("<mimic joint=\"left\"", "<mimic joint=\"right\""), "found a loop of <mimic>");
  EXPECT_HAS(refusal("<mimic joint=\"left\"", "<mimic"), "joint 'right': joint is missing");
  EXPECT_HAS(refusal("multiplier=\"-2\"", "multiplier=\"much\""), "joint 'right': multiplier is 'much'");
  EXPECT_HAS(refusal("lower=\"-0.4\" upper=\"0.1\"", "lower=\"1\" upper=\"2\""), "joint 'right' mimics 'left'");
}

}  // namespace
}  // namespace aras_visual_servo_sim::mimic_test
