// Each limit of a joint, on either side: the other side is far, so that this one alone binds.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "aras_visual_servo_sim/robot/joint_limits.hpp"

namespace aras_visual_servo_sim::limits_mirrored_test {
namespace {

constexpr double kFar = 1e6;
constexpr double kRounding = 1e-12;

/** Everything mirrored at 0 for the side -1. */
class Side : public ::testing::TestWithParam<double> {
 protected:
  const double sign_ = GetParam();

  /** A position limit at sign * at, the other one far. */
  JointLimits limitsAt(double at) const {
    JointLimits limits;
    limits.has_position = true;
    limits.lower = sign_ > 0.0 ? -kFar : -at;
    limits.upper = sign_ > 0.0 ? at : kFar;
    return limits;
  }

  SoftLimits softAt(double at, double k_position) const {
    SoftLimits soft;
    soft.present = true;
    soft.k_position = k_position;
    soft.lower = sign_ > 0.0 ? -kFar : -at;
    soft.upper = sign_ > 0.0 ? at : kFar;
    return soft;
  }

  /** The bound on this side, as it would be on the positive one. */
  double outer(const VelocityBounds& bounds) const { return sign_ > 0.0 ? bounds.max : -bounds.min; }
  double inner(const VelocityBounds& bounds) const { return sign_ > 0.0 ? bounds.min : -bounds.max; }
};

INSTANTIATE_TEST_SUITE_P(JointLimits, Side, ::testing::Values(1.0, -1.0));

TEST_P(Side, PositionsAndVelocitiesAreClamped) {
  JointLimits limits = limitsAt(1.0);
  EXPECT_EQ(clampPosition(limits, sign_ * 1.5), sign_ * 1.0);
  EXPECT_EQ(clampPosition(limits, sign_ * -1.5), sign_ * -1.5);
  limits.has_velocity = true;
  limits.velocity = 2.0;
  EXPECT_EQ(clampVelocity(limits, sign_ * 2.5), sign_ * 2.0);
  EXPECT_EQ(clampVelocity(limits, sign_ * 1.5), sign_ * 1.5);
}

TEST_P(Side, EffortThatLeavesThePositionLimitIsCutAndOnlyThat) {
  JointLimits limits = limitsAt(1.0);
  limits.has_effort = true;
  limits.effort = 10.0;
  const EffortBounds bounds = effortBounds(limits, sign_ * 1.1, 0.0);
  EXPECT_EQ(sign_ > 0.0 ? bounds.max : -bounds.min, 0.0);
  EXPECT_EQ(sign_ > 0.0 ? bounds.min : -bounds.max, -10.0);
}

TEST_P(Side, SoftLimitsSlowDownOnTheirSide) {
  JointLimits limits = limitsAt(2.0);
  limits.has_velocity = true;
  limits.velocity = 3.0;
  const SoftLimits soft = softAt(1.0, 4.0);
  const VelocityBounds bounds = softVelocityBounds(limits, soft, sign_ * 0.9);
  EXPECT_NEAR(outer(bounds), 0.4, kRounding);
  EXPECT_EQ(inner(bounds), -3.0);
  EXPECT_NEAR(outer(softVelocityBounds(limits, soft, sign_ * 1.1)), -0.4, kRounding);  // back
}

TEST_P(Side, SoftLimitsBoundThePositionCommand) {
  JointLimits limits = limitsAt(1.05);
  limits.has_velocity = true;
  limits.velocity = kFar;
  const SoftLimits soft = softAt(1.0, 4.0);
  EXPECT_NEAR(softPositionCommand(limits, soft, sign_ * 5.0, sign_ * 0.9, 0.1), sign_ * 0.94, kRounding);
  EXPECT_NEAR(softPositionCommand(limits, softAt(9.0, 4.0), sign_ * 5.0, sign_ * 0.9, 0.1), sign_ * 1.05, kRounding);
  EXPECT_NEAR(softPositionCommand(limits, soft, sign_ * 0.91, sign_ * 0.9, 0.1), sign_ * 0.91, kRounding);
}

TEST_P(Side, AccelerationAndDecelerationAreBounded) {
  JointLimits limits;
  limits.has_acceleration = true;
  limits.acceleration = 2.0;
  const VelocityBounds bounds = velocityCommandBounds(limits, SoftLimits(), 0.0, sign_ * 0.5, 0.1);
  EXPECT_NEAR(outer(bounds), 0.7, kRounding);  // faster
  EXPECT_NEAR(inner(bounds), 0.3, kRounding);  // slower
}

TEST_P(Side, CommandedVelocitiesAreBounded) {
  JointLimits limits;
  limits.has_velocity = true;
  limits.velocity = 2.0;
  EXPECT_EQ(outer(velocityCommandBounds(limits, SoftLimits(), 0.0, sign_ * 0.5, 0.1)), 2.0);
}

TEST_P(Side, TheTurnThatStaysWithinTheLimitsIsTaken) {
  const double pi = 3.14159265358979323846;
  const double from = sign_ * 0.75 * pi, to = sign_ * -0.75 * pi, limit = 0.9 * pi;
  EXPECT_NEAR(angularDistanceWithin(from, to, -limit, limit), sign_ * -1.5 * pi, kRounding);
  EXPECT_NEAR(angularDistanceWithin(from, to, -kFar, kFar), sign_ * 0.5 * pi, kRounding);
}

TEST(JointLimits, OfBoundsThatCrossTheUpperOneHolds) { EXPECT_EQ(saturate(0.0, 2.0, 1.0), 1.0); }

TEST(JointLimits, AJointWithoutLimitsIsNotBounded) {
  const JointLimits none;
  EXPECT_EQ(clampPosition(none, 5.0), 5.0);
  EXPECT_EQ(clampVelocity(none, -5.0), -5.0);
  EXPECT_EQ(effortBounds(none, 5.0, 5.0).max, std::numeric_limits<double>::infinity());
  EXPECT_EQ(softVelocityBounds(none, SoftLimits(), 5.0).max, std::numeric_limits<double>::infinity());
  EXPECT_EQ(velocityCommandBounds(none, SoftLimits(), 0.0, 0.0, 0.1).min, -std::numeric_limits<double>::infinity());
}

}  // namespace
}  // namespace aras_visual_servo_sim::limits_mirrored_test
