#include <algorithm>
#include <random>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "aras_visual_servo_sim/robot/joint_limits.hpp"
#include "aras_visual_servo_sim/robot/joint_limits_reader.hpp"
#include "physics/drive/joint_graph.hpp"
#include "tools/soft_slider.hpp"

namespace aras_visual_servo_sim::soft_limits_test {
namespace {

constexpr double kEps = 2.2e-16;
constexpr double kDt = 0.001;
constexpr double kVelocity = 2.0, kEffort = 40.0;
constexpr double kPosition = 12.0, kGain = 25.0, kLower = -0.2, kUpper = 0.3;

double sat(double value, double low, double high) { return std::min(std::max(value, low), high); }

/** EffortJointSoftLimitsHandle::enforceLimits of ros_control, written down again. */
double softEffort(double command, double position, double velocity) {
  const double v_low = sat(-kPosition * (position - kLower), -kVelocity, kVelocity);
  const double v_high = sat(-kPosition * (position - kUpper), -kVelocity, kVelocity);
  return sat(command, sat(-kGain * (velocity - v_low), -kEffort, kEffort),
             sat(-kGain * (velocity - v_high), -kEffort, kEffort));
}

WorldConfig drivenBy(ControllerType type, Drive drive = Drive::kImplicit) {
  WorldConfig config = weightless();
  config.drive = drive;
  config.controllers = {controllerOf("slide", type, PidGains{900.0, 0.0, 20.0, 0.0, 0.0, false})};
  return config;
}

TEST(SoftLimits, ExplicitEffortIsThatOfTheStateAtTheBeginningOfTheStep) {
  for (const double effort : {-30.0, 30.0}) {
    MultibodyWorld world(softModel(), drivenBy(ControllerType::kEffort, Drive::kExplicit));
    world.setEffort("slide", effort);
    bool bounded = false;
    for (int k = 0; k < 600; ++k) {
      const double expected = softEffort(effort, world.jointPositions()[0], world.jointVelocities()[0]);
      world.step();
      ASSERT_EQ(world.jointEfforts()[0], expected) << k;
      bounded = bounded || expected != effort;
    }
    EXPECT_TRUE(bounded);
  }
}

TEST(SoftLimits, ImplicitEffortIsThatOfTheVelocityAtTheEndOfTheStep) {
  for (const auto type : {ControllerType::kEffort, ControllerType::kEffortPosition}) {
    MultibodyWorld world(softModel(), drivenBy(type));
    type == ControllerType::kEffort ? world.setEffort("slide", -35.0) : world.setPosition("slide", 0.34);
    bool bounded = false;
    for (int k = 0; k < 3000; ++k) {
      const double q = world.jointPositions()[0];
      world.step();
      const double command = world.controllerState("slide_controller").command;
      const double expected = softEffort(command, q, world.jointVelocities()[0]);
      // The effort is solved for along with the velocity: rounding of p times the error, and of g v.
      ASSERT_NEAR(world.jointEfforts()[0], expected, 1e4 * kEps * (kEffort + std::abs(command))) << k;
      bounded = bounded || std::abs(expected - command) > 1.0;
    }
    EXPECT_TRUE(bounded);
    EXPECT_LT(std::abs(world.jointVelocities()[0]), 1e-2);  // the last of an exponential approach
    EXPECT_GE(world.jointPositions()[0], kLower - 1e-2);
    EXPECT_LE(world.jointPositions()[0], kUpper + 1e-2);
  }
}

TEST(SoftLimits, APositionJointFollowsTheLimitedCommand) {
  RobotModel model = softModel();
  model.joints[0].enforced.effort = 1e9;  // the actuator never lags behind
  MultibodyWorld world(model, drivenBy(ControllerType::kPosition));
  world.setPosition("slide", 0.345);
  double command = 0.0;
  for (int k = 0; k < 800; ++k) {
    const double v_low = sat(-kPosition * (command - kLower), -kVelocity, kVelocity);
    const double v_high = sat(-kPosition * (command - kUpper), -kVelocity, kVelocity);
    const double low = std::max(command + v_low * kDt, -0.25);
    const double high = std::min(command + v_high * kDt, 0.35);
    command = sat(0.345, low, high);
    world.step();
    ASSERT_NEAR(world.jointPositions()[0], command, 1e-12) << k;  // sums of 800 steps
  }
  EXPECT_NEAR(command, kUpper, 1e-3);  // the soft limit, not the set-point
}

TEST(SoftLimits, AVelocityJointSlowsDownBeforeThem) {
  MultibodyWorld world(softModel(), drivenBy(ControllerType::kVelocity));
  world.setControllerCommand("slide_controller", 1.5);
  for (int k = 0; k < 1000; ++k) {
    const double q = world.jointPositions()[0];
    const double v = world.jointVelocities()[0];
    world.step();
    const double target = sat(1.5, -kVelocity, sat(-kPosition * (q - kUpper), -kVelocity, kVelocity));
    // The motor's 40 N change 3 kg by 0.0133 m/s a step at most.
    const double reach = kEffort / 3.0 * kDt;
    ASSERT_NEAR(world.jointVelocities()[0], sat(target, v - reach, v + reach), 1e-12) << k;
  }
  EXPECT_NEAR(world.jointPositions()[0], kUpper, 1e-3);
}

TEST(SoftLimits, AVelocityJointKeepsItsAccelerationLimit) {
  RobotModel model = softModel();
  applyJointLimits(YAML::Load("{joint_limits: {slide: {has_acceleration_limits: true, max_acceleration: 3.0}}}"),
                   model);
  MultibodyWorld world(model, drivenBy(ControllerType::kVelocity));
  world.setControllerCommand("slide_controller", 0.5);
  for (int k = 1; k <= 100; ++k) {
    world.step();
    ASSERT_NEAR(world.jointVelocities()[0], 3.0 * kDt * k, 1e-12);
  }
}

TEST(SoftLimits, TheGraphIsTheClampedPidAndNeverIncreases) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  for (int trial = 0; trial < 500; ++trial) {
    ActuatorLaw law;
    law.a0 = 60.0 * unit(random);
    law.a1 = trial % 5 == 0 ? 0.0 : 40.0 * std::abs(unit(random));
    if (trial % 2) {
      law.b0 = 20.0 * unit(random);
      law.b1 = 30.0 * std::abs(unit(random));
      law.b_min = -8.0;
      law.b_max = 5.0;
    }
    law.soft = true;
    law.soft_gain = trial % 7 == 0 ? 0.0 : 30.0 * std::abs(unit(random));
    law.v_soft_low = unit(random) - 0.5;
    law.v_soft_high = law.v_soft_low + std::abs(unit(random));
    law.u_max = 40.0;
    law.u_min = -40.0;
    JointGraph graph;
    graph.build(law, 0.0, 0.0, -5.0, 5.0);
    double before = std::numeric_limits<double>::infinity();
    for (double v = -4.9995; v < 5.0; v += 0.001) {
      const double raw = law.a0 - law.a1 * v + sat(law.b0 - law.b1 * v, law.b_min, law.b_max);
      const double expected = sat(raw, sat(-law.soft_gain * (v - law.v_soft_low), -40.0, 40.0),
                                  sat(-law.soft_gain * (v - law.v_soft_high), -40.0, 40.0));
      bool vertical = false;
      const JointGraph::Line line = graph.line(graph.locate(v, vertical));
      ASSERT_NEAR(line.c - line.g * v, expected, 1e-11) << trial << " at " << v;
      ASSERT_LE(expected, before + 1e-11);
      before = expected;
    }
  }
}

TEST(SoftLimits, WhatTheyNeedIsAskedFor) {
  RobotModel model = softModel();
  model.joints[0].enforced.has_velocity = false;
  EXPECT_HAS(messageOf<ParameterError>([&] { MultibodyWorld(model, drivenBy(ControllerType::kEffort)); }),
             "joint 'slide': has soft limits and no velocity limit");
  model = softModel();
  model.joints[0].enforced.has_effort = false;
  EXPECT_HAS(messageOf<ParameterError>([&] { MultibodyWorld(model, drivenBy(ControllerType::kEffort)); }),
             "joint 'slide': has soft limits and no effort limit");
  MultibodyWorld(model, drivenBy(ControllerType::kPosition));
}

TEST(AngularDistance, TakesTheShorterWayThatStaysWithinTheLimits) {
  const double turn = 2.0 * kPi;
  EXPECT_NEAR(angularDistanceWithin(0.0, 10.5 * kPi, -turn, turn), 0.5 * kPi, 20 * kEps);
  EXPECT_NEAR(angularDistanceWithin(0.0, 10.5 * kPi, -turn, 0.1 * kPi), -1.5 * kPi, 20 * kEps);
  EXPECT_NEAR(angularDistanceWithin(-6.0, 6.0, -turn, turn), 12.0 - turn, 20 * kEps);
  EXPECT_NEAR(angularDistanceWithin(6.0, 6.1, -turn, turn), 0.1, 20 * kEps);
}

TEST(AngularDistance, ARevoluteJointOfMoreThanATurnGoesTheShorterWay) {
  std::string urdf = replaced(readUrdf("slider.urdf"), "prismatic", "revolute");
  urdf = replaced(urdf, "lower=\"-100\" upper=\"100\"", "lower=\"-6.2831853\" upper=\"6.2831853\"");
  WorldConfig config = weightless();
  config.controllers = {
      controllerOf("slide", ControllerType::kEffortPosition, PidGains{50.0, 0.0, 20.0, 0.0, 0.0, false})};
  MultibodyWorld world(modelOf(urdf), config);
  world.reset(vectorOf({-3.0}));
  world.setPosition("slide", 6.0);  // 9 rad away, or 9 - 2 pi
  world.step(8000);
  EXPECT_NEAR(world.jointPositions()[0], 6.0 - 2.0 * kPi, 1e-6);
}

TEST(CommandTimeout, EffortsAndVelocitiesOfADeadPublisherEndWhenConfigured) {
  for (const double timeout_s : {0.0, 0.05}) {
    for (const auto type : {ControllerType::kEffort, ControllerType::kVelocity, ControllerType::kEffortVelocity}) {
      WorldConfig config = weightless();
      config.controllers = {controllerOf("slide", type, PidGains{50.0, 0.0, 0.0, 0.0, 0.0, false})};
      config.controllers[0].command_timeout_s = timeout_s;
      MultibodyWorld world(sliderModel(), config);
      world.step(7);
      world.setControllerCommand("slide_controller", 0.5);
      world.step(50);
      EXPECT_EQ(world.controllerState("slide_controller").set_point, 0.5);
      world.step();
      EXPECT_EQ(world.controllerState("slide_controller").set_point, timeout_s > 0.0 ? 0.0 : 0.5);
    }
  }
}

TEST(Controllers, MustFitTheHardwareInterfaceOfTheTransmission) {
  const RobotModel model = modelOf(readUrdf("two_link_full.urdf"));
  const std::string text = messageOf<ParameterError>([&] {
    parseControllers(YAML::Load("{arm: {type: position_controllers/JointPositionController, joint: b_swing}}"), model);
  });
  EXPECT_HAS(text,
             "arm.type: found position_controllers/JointPositionController (PositionJointInterface), allowed one "
             "for EffortJointInterface, the hardware interface of the <transmission> of joint 'b_swing'");
}

}  // namespace
}  // namespace aras_visual_servo_sim::soft_limits_test
