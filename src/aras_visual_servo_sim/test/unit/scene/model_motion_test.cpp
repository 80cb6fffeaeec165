#include "aras_visual_servo_sim/scene/model_motion.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "aras_visual_servo_sim/simulation/state/run_hash.hpp"
#include "tools/pan_lift.hpp"

namespace aras_visual_servo_sim::model_motion_test {
namespace {

constexpr double kStepS = 1e-5;  // of the central differences
// Truncation kStepS^2 |x'''| / 6 with third derivatives below 100, rounding 1e-16 / kStepS.
constexpr double kDifference = 1e-8;
constexpr double kRounding = 1e-12;

ModelMotion motion(const std::string& yaml) { return ModelMotion::fromYaml(YAML::Load(yaml), "motion"); }

Pose tilted() { return {{0.1, -0.2, 0.3}, quaternionFromRpy({0.4, -0.3, 1.1})}; }

const std::vector<std::string>& everyMotion() {
  static const std::vector<std::string> motions = {
      "{type: constant_velocity, linear_m_per_s: [0.1, -0.2, 0.05], angular_rad_per_s: [0.3, 0.5, -0.7]}",
      "{type: circle, radius_m: 0.2, angular_speed_rad_per_s: -1.3, axis: [1, 2, 3], phase_rad: 0.7}",
      "{type: circle, radius_m: 0.2, angular_speed_rad_per_s: 1.3, axis: [1, 0, 0]}",
      "{type: random_walk, interval_s: 0.05, speed_stddev_m_per_s: [0.1, 0.2, 0.3],"
      " angular_speed_stddev_rad_per_s: [0.5, 0.4, 0.3], radius_m: 0.03, seed: 4}",
      "{type: waypoints, repeat: true, waypoints: [{time_s: 0.4, position_m: [0.2, 0.1, 0.3], rpy_rad: [1, 0.2, 3]},"
      " {time_s: 0.7, position_m: [0, 0, 0.1]}, {time_s: 1.1, position_m: [0.1, -0.2, 0.3], rpy_rad: [0.4, -0.3, "
      "1.1]}]}",
      "{type: circle, radius_m: 0.1, angular_speed_rad_per_s: 2.0, delay_s: 0.53}"};
  return motions;
}

TEST(ModelMotion, StartsWhereTheModelIs) {
  for (const std::string& yaml : everyMotion()) {
    const ModelPlacement start = motion(yaml).at(tilted(), 0.0);
    EXPECT_LT((start.X_WM.matrix() - tilted().matrix()).norm(), kRounding) << yaml;
  }
}

TEST(ModelMotion, TwistIsTheDerivativeOfThePose) {
  for (const std::string& yaml : everyMotion()) {
    const ModelMotion moving = motion(yaml);
    for (const double t : {0.011, 0.27, 0.51, 0.62, 0.93, 1.31}) {  // no corner of a path within a step of them
      const ModelPlacement before = moving.at(tilted(), t - kStepS), after = moving.at(tilted(), t + kStepS);
      const Twist V = moving.at(tilted(), t).V_WM_W;
      const Eigen::Vector3d v = (after.X_WM.p - before.X_WM.p) / (2.0 * kStepS);
      const Eigen::AngleAxisd turn(after.X_WM.q * before.X_WM.q.conjugate());
      const Eigen::Vector3d w = turn.angle() * turn.axis() / (2.0 * kStepS);
      EXPECT_LT((V.head<3>() - v).norm(), kDifference) << yaml << " at " << t;
      EXPECT_LT((V.tail<3>() - w).norm(), kDifference) << yaml << " at " << t;
    }
  }
}

TEST(ModelMotion, CircleStaysAtItsRadiusInItsPlane) {
  const Eigen::Vector3d axis = Eigen::Vector3d(1, 2, 3).normalized();
  const ModelMotion circle = motion(everyMotion()[1]);
  const double half_turn_s = M_PI / 1.3;
  const Eigen::Vector3d start = circle.at(tilted(), 0.0).X_WM.p;
  const Eigen::Vector3d centre = 0.5 * (start + circle.at(tilted(), half_turn_s).X_WM.p);
  for (const double t : {0.0, 0.4, 1.7, 30.0}) {
    const Eigen::Vector3d radius = circle.at(tilted(), t).X_WM.p - centre;
    EXPECT_NEAR(radius.norm(), 0.2, kRounding);
    EXPECT_NEAR(radius.dot(axis), 0.0, kRounding);
  }
}

TEST(ModelMotion, RandomWalkIsTheSameWhateverWasAskedBefore) {
  const ModelMotion walked = motion(everyMotion()[3]), fresh = motion(everyMotion()[3]);
  walked.at(tilted(), 7.0);
  for (const double t : {3.0, 5.01, 1.0}) {
    EXPECT_EQ(walked.at(tilted(), t).X_WM.matrix(), motion(fresh.yaml()).at(tilted(), t).X_WM.matrix());
  }
}

TEST(ModelMotion, RandomWalkStaysNearAndItsSeedMatters) {
  const ModelMotion walk = motion(everyMotion()[3]);
  // Once outside it turns back: a step of the largest of some thousand draws (4 sigma, all three at once) is the
  // margin.
  const double margin = 0.05 * 4.0 * std::sqrt(0.01 + 0.04 + 0.09);
  for (int k = 0; k < 2000; ++k) {
    EXPECT_LT((walk.at(tilted(), 0.05 * k).X_WM.p - tilted().p).norm(), 0.03 + margin);
  }
  ModelMotion other = motion("{type: random_walk, interval_s: 0.05, speed_stddev_m_per_s: [1, 1, 1], seed: 5}");
  ModelMotion same = motion("{type: random_walk, interval_s: 0.05, speed_stddev_m_per_s: [1, 1, 1], seed: 6}");
  EXPECT_GT((other.at(tilted(), 1.0).X_WM.p - same.at(tilted(), 1.0).X_WM.p).norm(), 1e-3);
}

TEST(ModelMotion, WaypointsAreMetInTimeAndTheLastOneIsKept) {
  const std::string points =
      "[{time_s: 0.5, position_m: [1, 0, 0], rpy_rad: [0, 0, 1]}, {time_s: 2, position_m: [1, 3, 0]}]";
  const ModelMotion once = motion("{type: waypoints, waypoints: " + points + "}");
  EXPECT_LT((once.at(Pose(), 0.5).X_WM.p - Eigen::Vector3d(1, 0, 0)).norm(), kRounding);
  EXPECT_LT((once.at(Pose(), 1.0).X_WM.p - Eigen::Vector3d(1, 1, 0)).norm(), kRounding);
  EXPECT_LT((once.at(Pose(), 9.0).X_WM.p - Eigen::Vector3d(1, 3, 0)).norm(), kRounding);
  EXPECT_EQ(once.at(Pose(), 9.0).V_WM_W, Twist::Zero());
  EXPECT_NEAR(once.at(Pose(), 9.0).X_WM.q.angularDistance(quaternionFromRpy({0, 0, 1})), 0.0, 1e-7);  // acos near 1
  const ModelMotion again = motion("{type: waypoints, repeat: true, waypoints: " + points + "}");
  EXPECT_LT((again.at(Pose(), 2.25).X_WM.p - Eigen::Vector3d(0.5, 0, 0)).norm(), kRounding);
}

TEST(ModelMotion, AllFaultsAreInOneMessage) {
  try {
    motion("{type: circle, radius_m: -1, axis: [0, 0, 0], delay_s: .nan, colour: red}");
    FAIL() << "was accepted";
  } catch (const ParameterError& error) {
    for (const char* key : {"radius_m", "angular_speed_rad_per_s", "axis", "delay_s", "colour"}) {
      EXPECT_NE(std::string(error.what()).find(key), std::string::npos) << error.what();
    }
  }
  EXPECT_THROW(motion("{type: dance}"), ParameterError);
  EXPECT_THROW(motion("{type: waypoints}"), ParameterError);
  EXPECT_THROW(motion("{type: waypoints, waypoints: [{time_s: 1, position_m: [0, 0, 0]},"
                      " {time_s: 1, position_m: [0, 0, 1]}]}"),
               ParameterError);
}

TEST(ModelMotion, WhatLeavesEveryRoomIsRefused) {
  for (const char* far : {"{type: waypoints, waypoints: [{time_s: 1, position_m: [1.0e+308, 0, 0]}]}",
                          "{type: waypoints, waypoints: [{time_s: 1.0e+300, position_m: [0, 0, 0]}]}",
                          "{type: constant_velocity, linear_m_per_s: [0, 0, -1.0e+5]}",
                          "{type: constant_velocity, angular_rad_per_s: [0, 1.0e+200, 0]}",
                          "{type: circle, radius_m: 1.0e+100, angular_speed_rad_per_s: 1}",
                          "{type: circle, radius_m: 1, angular_speed_rad_per_s: 1.0e+100}",
                          "{type: random_walk, interval_s: 1, speed_stddev_m_per_s: [1.0e+308, 0, 0]}"}) {
    EXPECT_THROW(motion(far), ParameterError) << far;
  }
}

// --- in a simulation ------------------------------------------------------------------------------------------------

const char* const kScene =
    "scene: {models: [{name: target, outlines_m: [[[0, 0], [0.1, 0], [0, 0.1]]],"
    " motion: {type: constant_velocity, linear_m_per_s: [0.02, 0, 0]}}],"
    " solids: [{name: box, box_m: [0.1, 0.1, 0.1], position_m: [0, 1, 0],"
    " motion: {type: random_walk, interval_s: 0.1, speed_stddev_m_per_s: [0.1, 0.1, 0], seed: 3}}]}";

TEST(MovingModels, FollowSimulatedTimeAndTheirTwistIsKnown) {
  Simulation simulation = fixture::panLift(kScene);
  simulation.step(500);
  EXPECT_NEAR(simulation.models().pose("target").p.x(), 0.01, kRounding);
  EXPECT_EQ(simulation.modelTwist("target")[0], 0.02);
  EXPECT_GT((simulation.models().pose("box").p - Eigen::Vector3d(0, 1, 0)).norm(), 0.0);
  EXPECT_THROW(simulation.modelTwist("moon"), UnknownNameError);
}

TEST(MovingModels, ResetStartsThemAgainAndRestoreContinuesThem) {
  Simulation simulation = fixture::panLift(kScene);
  const std::string hash = fixture::hashOf(simulation, 6);
  simulation.setModelMotion("target", motion(everyMotion()[1]));
  fixture::hashOf(simulation, 2);
  const std::string state = simulation.saveState();
  const std::string later = fixture::hashOf(simulation, 9);
  simulation.setModelPose("box", Pose());
  simulation.restoreState(state);
  EXPECT_EQ(fixture::hashOf(simulation, 9), later);
  simulation.reset();
  EXPECT_EQ(fixture::hashOf(simulation, 6), hash);
}

TEST(MovingModels, AForgedMotionInASavedStateIsRefused) {
  Simulation simulation = fixture::panLift(kScene);
  const std::string good = simulation.saveState();
  for (const auto& [from, to] : {std::pair{"constant_velocity", "constant_velocit{"}, {"random_walk", "random_wal]"}}) {
    std::string state = good.substr(0, good.size() - sizeof(std::uint64_t));
    state.replace(state.find(from), std::string(from).size(), to);
    RunHash checksum;
    checksum.add(state.data(), state.size());
    const std::uint64_t sum = checksum.state();
    state.append(reinterpret_cast<const char*>(&sum), sizeof(sum));
    EXPECT_THROW(simulation.restoreState(state), ArasError) << to;
  }
  simulation.restoreState(good);
}

TEST(MovingModels, MotionGivenLaterStartsThenAndPlacingEndsIt) {
  Simulation simulation = fixture::panLift(kScene);
  simulation.step(100);
  const Pose before = simulation.models().pose("target");
  simulation.setModelMotion("target", motion("{type: constant_velocity, linear_m_per_s: [0, 1, 0]}"));
  EXPECT_EQ(simulation.models().pose("target").p, before.p);
  simulation.step(100);
  EXPECT_NEAR(simulation.models().pose("target").p.y(), 0.1, kRounding);
  simulation.setModelPose("target", tilted());
  simulation.step(100);
  EXPECT_EQ(simulation.models().pose("target").p, tilted().p);
  EXPECT_EQ(simulation.modelTwist("target"), Twist::Zero());
  EXPECT_THROW(simulation.setModelMotion("moon", std::nullopt), UnknownNameError);
}

TEST(MovingModels, ResetOfTheWorldStartsMotionsAgainWithoutTurningTimeBack) {
  Simulation simulation = fixture::panLift(kScene);
  simulation.step(500);
  simulation.resetWorld();
  EXPECT_EQ(simulation.models().pose("target").p.x(), 0.0);
  simulation.step(250);
  EXPECT_EQ(simulation.ticks(), 750);
  EXPECT_NEAR(simulation.models().pose("target").p.x(), 0.005, kRounding);
}

}  // namespace
}  // namespace aras_visual_servo_sim::model_motion_test
