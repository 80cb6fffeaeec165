// Flat models that a link of the robot carries.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "tools/pan_lift.hpp"

namespace aras_visual_servo_sim::carried_test {
namespace {

/** Poses come from a product of two: a few roundings of numbers near 1. */
constexpr double kRounding = 1e-12;
/** Of a central difference over two periods of 1 ms: h^2 times the jerk, and what friction changes meanwhile. */
constexpr double kDifference = 1e-3;

const char* const kOutline = "outlines_m: [[[-0.1, -0.05], [0.1, -0.05], [0.1, 0.05], [-0.1, 0.05]]]";

/** The target 0.2 m beyond the head, which goes up with the lift and turns with the pan. */
std::string carried(const std::string& more = "") {
  return "{scene: {background_rgb: [230, 230, 230], models: [{name: target, attached_to: head, position_m: [0.3, 0.1, "
         "-0.2], rpy_rad: [0.1, 0.2, 0.3], color_rgb: [20, 20, 20], " +
         std::string(kOutline) + "}" + more + "]}}";
}

Pose onTheHead() { return {{0.3, 0.1, -0.2}, quaternionFromRpy({0.1, 0.2, 0.3})}; }

void expectCarried(const Simulation& simulation, const Pose& X_LM, const std::string& link = "head") {
  const Pose expected = simulation.body().linkPose(link) * X_LM;
  const Pose& found = simulation.models().pose("target");
  EXPECT_NEAR((found.p - expected.p).norm(), 0.0, kRounding);
  EXPECT_NEAR((found.q.coeffs() - expected.q.coeffs()).norm(), 0.0, kRounding);
}

TEST(CarriedModels, AreWhereTheirLinkIsFromTheStart) { expectCarried(fixture::panLift(carried()), onTheHead()); }

TEST(CarriedModels, MoveWithTheLinkInStepsAndJumps) {
  Simulation simulation = fixture::panLift(carried());
  const Pose before = simulation.models().pose("target");
  simulation.setJointPositions({{"lift", 0.15}, {"pan", 0.4}});
  expectCarried(simulation, onTheHead());
  EXPECT_GT((simulation.models().pose("target").p - before.p).norm(), 0.1);
  simulation.setCommand({{}, {{"lift", -0.3}, {"pan", 0.8}}, {}});
  const Pose still = simulation.models().pose("target");
  simulation.step(50);
  expectCarried(simulation, onTheHead());
  EXPECT_GT((simulation.models().pose("target").p - still.p).norm(), 1e-3);
  EXPECT_TRUE(simulation.modelsMove());
}

TEST(CarriedModels, AreInTheImageAndInTheTruthOfTheFrame) {
  Simulation simulation = fixture::panLift(
      "{scene: {background_rgb: [230, 230, 230], models: [{name: target, attached_to: eye_optical_frame, position_m: "
      "[0, 0, 0.4], rpy_rad: [3.14159265358979, 0, 0], color_rgb: [20, 20, 20], " +
      std::string(kOutline) + "}]}}");
  simulation.stepToImage("camera");
  const std::vector<std::uint8_t> before = simulation.render(0).data;
  simulation.setJointPositions({{"lift", 0.1}, {"pan", 0.5}});
  simulation.stepToImage("camera");
  EXPECT_EQ(simulation.render(0).data, before);  // it moves with the camera, so that the camera sees no change
  const FrameState frame = simulation.frameState(0);
  EXPECT_NEAR((frame.X_WC.inverse() * frame.models.at("target")).p.z(), 0.4, kRounding);
}

TEST(CarriedModels, HaveTheTwistOfTheirPlaceOnTheLink) {
  Simulation simulation = fixture::panLift(carried());
  simulation.setCommand({{}, {{"lift", 0.2}, {"pan", 0.9}}, {}});
  simulation.step(60);
  const Pose before = simulation.models().pose("target");
  simulation.step(1);
  const Twist twist = simulation.modelTwist("target");
  simulation.step(1);
  const Pose after = simulation.models().pose("target");
  const Eigen::AngleAxisd turn(after.q * before.q.inverse());
  EXPECT_NEAR((twist.head<3>() - (after.p - before.p) / 2e-3).norm(), 0.0, kDifference);
  EXPECT_NEAR((twist.tail<3>() - turn.angle() * turn.axis() / 2e-3).norm(), 0.0, kDifference);
  EXPECT_GT(twist.tail<3>().norm(), 0.1);
}

TEST(CarriedModels, PlacedAnewStayThereOnTheLinkUntilAReset) {
  Simulation simulation = fixture::panLift(carried());
  const Pose X_WM{{0.5, 0.1, 0.2}, quaternionFromRpy({0.0, 0.3, 0.0})};
  simulation.setModelPose("target", X_WM);
  const Pose X_LM = simulation.body().linkPose("head").inverse() * X_WM;
  expectCarried(simulation, X_LM);
  simulation.setJointPositions({{"pan", 0.7}});
  expectCarried(simulation, X_LM);
  simulation.reset();
  expectCarried(simulation, onTheHead());
}

TEST(CarriedModels, AreInTheSavedStateBitForBit) {
  Simulation simulation = fixture::panLift(carried());
  simulation.setModelPose("target", Pose{{0.02, 0.01, 0.03}, quaternionFromRpy({0.0, 0.3, 0.1})});
  simulation.setCommand({{}, {{"lift", 0.1}, {"pan", 0.9}}, {}});
  fixture::hashOf(simulation, 3);
  const std::string state = simulation.saveState();
  const Pose here = simulation.models().pose("target");
  const std::string later = fixture::hashOf(simulation, 4);
  Simulation other = fixture::panLift(carried());
  other.restoreState(state);
  EXPECT_EQ(other.models().pose("target").p, here.p);
  EXPECT_EQ(other.models().pose("target").q.coeffs(), here.q.coeffs());
  EXPECT_EQ(fixture::hashOf(other, 4), later);
}

TEST(CarriedModels, CanBeSpawnedWhereTheyAreInTheWorld) {
  Simulation simulation = fixture::panLift();
  simulation.setJointPositions({{"pan", 0.4}});
  const Pose X_WM{{0.5, 0.1, 0.2}, quaternionFromRpy({0.0, 0.3, 0.0})};
  simulation.deleteModel("target");
  simulation.spawnModel(YAML::Load("{name: target, attached_to: head, " + std::string(kOutline) + "}"), X_WM);
  EXPECT_NEAR((simulation.models().pose("target").p - X_WM.p).norm(), 0.0, kRounding);
  const Pose X_LM = simulation.body().linkPose("head").inverse() * X_WM;
  simulation.setJointPositions({{"pan", -0.4}, {"lift", 0.1}});
  expectCarried(simulation, X_LM);
}

TEST(CarriedModels, RefuseUnknownLinksAndMotions) {
  const std::string motion = "motion: {type: circle, radius_m: 0.05, angular_speed_rad_per_s: 3.0}";
  const auto refusal = [](const std::string& sim) {
    try {
      fixture::panLift(sim);
    } catch (const ParameterError& error) {
      return std::string(error.what());
    }
    return std::string("was accepted");
  };
  const std::string unknown = refusal(carried(", {name: b, attached_to: tail, " + std::string(kOutline) + "}"));
  EXPECT_NE(unknown.find("model 'b': attached_to: found tail, allowed "), std::string::npos) << unknown;
  EXPECT_NE(unknown.find("head"), std::string::npos) << unknown;
  const std::string both = refusal(carried(", {name: b, attached_to: head, " + motion + ", " + kOutline + "}"));
  EXPECT_NE(both.find("together with attached_to"), std::string::npos) << both;
  Simulation simulation = fixture::panLift(carried());
  EXPECT_THROW(simulation.setModelMotion("target", ModelMotion::fromYaml(YAML::Load("{type: constant_velocity}"), "m")),
               ParameterError);
  EXPECT_THROW(simulation.spawnModel(YAML::Load("{name: b, attached_to: tail, " + std::string(kOutline) + "}")),
               ParameterError);
  EXPECT_EQ(simulation.models().names(), std::vector<std::string>{"target"});
}

}  // namespace
}  // namespace aras_visual_servo_sim::carried_test
