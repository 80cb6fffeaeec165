// Limits that a YAML file gives in the place of the URDF's.
#include "aras_visual_servo_sim/robot/joint_limits_reader.hpp"

#include "aras_visual_servo_sim/config/errors.hpp"
#include "tools/soft_slider.hpp"

namespace aras_visual_servo_sim::joint_limits_reader_test {
namespace {

TEST(JointLimitOverrides, ChangeWhatIsCompleteAndNothingElse) {
  RobotModel model = softModel();
  applyJointLimits(
      YAML::Load("{joint_limits: {slide: {has_position_limits: true, min_position: -0.1, max_position: 0.1,"
                 " has_velocity_limits: true, max_velocity: 0.5, has_effort_limits: false, max_effort: 9,"
                 " has_soft_limits: true, k_position: 1, k_velocity: 2, soft_lower_limit: -0.05,"
                 " soft_upper_limit: 0.05}}}"),
      model);
  const Joint& joint = model.movingJoint(0);
  EXPECT_EQ(joint.enforced.lower, -0.1);
  EXPECT_EQ(joint.enforced.velocity, 0.5);
  EXPECT_FALSE(joint.enforced.has_effort);
  EXPECT_EQ(joint.soft.upper, 0.05);
  EXPECT_EQ(joint.soft.k_velocity, 2.0);
  EXPECT_EQ(joint.limits.lower, -0.25);  // the stop stays
  EXPECT_TRUE(joint.limits.has_effort);
}

TEST(JointLimitOverrides, SoftLimitsThatCrossAreRefused) {
  RobotModel model = softModel();
  const std::string text = messageOf<ParameterError>([&] {
    applyJointLimits(YAML::Load("{joint_limits: {slide: {has_soft_limits: true, k_position: 1, k_velocity: 2,"
                                " soft_lower_limit: 0.1, soft_upper_limit: 0.05}}}"),
                     model);
  });
  EXPECT_HAS(text, "joint_limits.slide.soft_lower_limit: found 0.1, allowed <= soft_upper_limit, 0.05");
}

TEST(JointLimitOverrides, EachNumberGoesToTheLimitOfItsName) {
  RobotModel model = softModel();
  model.joints[0].soft = SoftLimits{};  // as where the URDF has none
  applyJointLimits(
      YAML::Load("{joint_limits: {slide: {has_position_limits: true, min_position: -0.1, max_position: 0.2,"
                 " has_velocity_limits: true, max_velocity: 0.5, has_effort_limits: true, max_effort: 9,"
                 " has_acceleration_limits: true, max_acceleration: 3, has_soft_limits: true, k_position: 1,"
                 " k_velocity: 2, soft_lower_limit: -0.05, soft_upper_limit: 0.06}}}"),
      model);
  const JointLimits& limits = model.movingJoint(0).enforced;
  const SoftLimits& soft = model.movingJoint(0).soft;
  EXPECT_TRUE(limits.has_position && limits.has_velocity && limits.has_effort && limits.has_acceleration);
  EXPECT_EQ(limits.lower, -0.1);
  EXPECT_EQ(limits.upper, 0.2);
  EXPECT_EQ(limits.velocity, 0.5);
  EXPECT_EQ(limits.effort, 9.0);
  EXPECT_EQ(limits.acceleration, 3.0);
  EXPECT_TRUE(soft.present);
  EXPECT_EQ(soft.k_position, 1.0);
  EXPECT_EQ(soft.k_velocity, 2.0);
  EXPECT_EQ(soft.lower, -0.05);
  EXPECT_EQ(soft.upper, 0.06);
}

TEST(JointLimitOverrides, WhatIsIncompleteIsPassedOverWithAWarning) {
  RobotModel model = softModel();
  const std::size_t before = model.warnings.size();
  applyJointLimits(YAML::Load("{joint_limits: {slide: {has_position_limits: true, min_position: -0.1, max_velocity: 1,"
                              " has_soft_limits: false, k_position: 3, has_jerk_limits: true, max_jerk: 4},"
                              " elbow: {has_effort_limits: false}}}"),
                   model);
  EXPECT_EQ(model.movingJoint(0).enforced.lower, -0.25);
  EXPECT_EQ(model.movingJoint(0).enforced.velocity, 2.0);
  EXPECT_EQ(model.movingJoint(0).soft.k_position, 12.0);
  std::string all;
  for (std::size_t k = before; k < model.warnings.size(); ++k) all += model.warnings[k] + "\n";
  EXPECT_HAS(all, "joint_limits/slide: has_position_limits");
  EXPECT_HAS(all, "joint_limits/slide: has_jerk_limits");
  EXPECT_HAS(all, "joint_limits/elbow");
}

TEST(JointLimitOverrides, AFixedJointGetsNoneAndIsWarnedAbout) {
  RobotModel model = modelOf(readUrdf("two_link_full.urdf"));
  const std::size_t before = model.warnings.size();
  applyJointLimits(YAML::Load("{joint_limits: {mount: {has_velocity_limits: true, max_velocity: 1}}}"), model);
  for (const Joint& joint : model.joints) EXPECT_FALSE(joint.name == "mount" && joint.enforced.has_velocity);
  ASSERT_EQ(model.warnings.size(), before + 1);
  EXPECT_HAS(model.warnings.back(), "joint_limits/mount");
}

TEST(JointLimitOverrides, GainsOfTheSimulatedHardwareAreWarnedAbout) {
  RobotModel model = sliderModel();
  const std::size_t before = model.warnings.size();
  applyJointLimits(YAML::Load("{gazebo_ros_control: {pid_gains: {slide: {p: 100.0}}}}"), model);
  ASSERT_EQ(model.warnings.size(), before + 1);
  EXPECT_HAS(model.warnings.back(), "gazebo_ros_control/pid_gains (slide)");
  applyJointLimits(YAML::Load("{gazebo_ros_control: 3}"), model);
  EXPECT_EQ(model.warnings.size(), before + 1);
}

TEST(JointLimitOverrides, ANameThatIsAListOrAMapIsNoJoint) {
  RobotModel model = sliderModel();
  const std::size_t before = model.warnings.size();
  applyJointLimits(YAML::Load("{joint_limits: {[slide]: {max_effort: 1}, {slide: 1}: 2}}"), model);
  ASSERT_EQ(model.warnings.size(), before + 2);
  EXPECT_HAS(model.warnings[before], "joint_limits/[slide]");
  EXPECT_HAS(model.warnings.back(), "joint_limits/{slide: 1}");
}

TEST(JointLimitOverrides, FaultsAreListed) {
  RobotModel model = softModel();
  const std::string text = messageOf<ParameterError>([&] {
    applyJointLimits(YAML::Load("{joint_limits: {slide: {has_position_limits: true, min_position: 2, max_position: 1,"
                                " max_speed: 3, has_velocity_limits: perhaps, max_effort: .nan}}}"),
                     model);
  });
  EXPECT_HAS(text, "joint_limits.slide.min_position: found 2, allowed <= max_position");
  EXPECT_HAS(text, "joint_limits.slide.max_speed: found an unknown key");
  EXPECT_HAS(text, "joint_limits.slide.has_velocity_limits: found perhaps, allowed true or false");
  EXPECT_HAS(text, "joint_limits.slide.max_effort: found .nan");
}

}  // namespace
}  // namespace aras_visual_servo_sim::joint_limits_reader_test
