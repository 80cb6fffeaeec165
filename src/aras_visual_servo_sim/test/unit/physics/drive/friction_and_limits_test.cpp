#include "aras_visual_servo_sim/config/errors.hpp"
#include "tools/physics_tools.hpp"

namespace aras_visual_servo_sim::friction_and_limits_test {
namespace {

constexpr double kMass = 3.0;
constexpr double kEps = 2.2e-16;
// A first-order method: halving the period halves the error, up to terms of second order.
constexpr double kHalf = 0.5;
constexpr double kSecondOrder = 0.01;

WorldConfig withEffort(double period_s = 0.001) {
  WorldConfig config = weightless(period_s);
  config.controllers = {controllerOf("slide", ControllerType::kEffort)};
  return config;
}

TEST(Friction, ASlidingBlockStopsAfterVSquaredOverTwoA) {
  const double friction = 6.0, v0 = 2.0;
  MultibodyWorld world(sliderModel(friction), weightless());
  world.setJointVelocities(vectorOf({v0}));
  world.step(1500);
  const double expected = v0 * v0 / (2.0 * friction / kMass);
  EXPECT_NEAR(world.jointPositions()[0], expected, v0 * 0.001);  // one period at the initial velocity
  EXPECT_EQ(world.jointVelocities()[0], 0.0);
}

TEST(Friction, HoldsExactlyBelowItsLimitAndSlidesAboveIt) {
  const double friction = 6.0;
  MultibodyWorld world(sliderModel(friction), withEffort());
  world.setEffort("slide", 5.9);
  world.step(1000);
  EXPECT_EQ(world.jointPositions()[0], 0.0);
  EXPECT_EQ(world.jointVelocities()[0], 0.0);
  EXPECT_EQ(world.jointEfforts()[0], 5.9);
  world.setEffort("slide", -6.6);
  world.step(1000);
  EXPECT_NEAR(world.jointVelocities()[0], -0.6 / kMass, 1000 * 10 * kEps);
}

TEST(Friction, StopsABlockThatReversesUnderGravityAndHoldsItThere) {
  WorldConfig config;
  config.gravity_m_s2 = {-1.9, 0.0, 0.0};  // 5.7 N, less than the friction
  MultibodyWorld world(sliderModel(6.0), config);
  world.setJointVelocities(vectorOf({1.0}));
  world.step(2000);
  const double there = world.jointPositions()[0];
  EXPECT_EQ(world.jointVelocities()[0], 0.0);
  world.step(1000);
  EXPECT_EQ(world.jointPositions()[0], there);
}

/** A block with Stribeck friction: 6 N that 2 N of static friction are added to, which fade with 0.5 m/s. */
RobotModel stribeckModel(double damping = 0.0) {
  std::string urdf = replaced(readUrdf("slider.urdf"), "friction=\"0\"",
                              "friction=\"6\" static_friction=\"8\" stribeck_velocity=\"0.5\"");
  std::ostringstream text;
  text << "damping=\"" << damping << "\"";
  return modelOf(replaced(urdf, "damping=\"0\"", text.str()));
}

TEST(Stribeck, HoldsExactlyBelowStaticFrictionAndSlidesAgainstCoulombFriction) {
  MultibodyWorld world(stribeckModel(), withEffort());
  world.setEffort("slide", 7.9);
  world.step(1000);
  EXPECT_EQ(world.jointPositions()[0], 0.0);
  EXPECT_EQ(world.jointVelocities()[0], 0.0);
  EXPECT_EQ(world.jointEfforts()[0], 7.9);
  world.setEffort("slide", 9.0);
  world.step(4000);
  const double before = world.jointVelocities()[0];
  ASSERT_GT(before, 2.5);  // 5 Stribeck velocities: exp(-25) of the static friction is left
  world.step(1000);
  EXPECT_NEAR(world.jointVelocities()[0] - before, 3.0 / kMass, 1e-10);
}

TEST(Stribeck, AServoAtASpeedMeasuresTheCurve) {
  const double speeds[] = {0.05, 0.3, -0.5, 1.5};
  WorldConfig config = weightless();
  config.controllers = {controllerOf("slide", ControllerType::kVelocity)};
  MultibodyWorld world(stribeckModel(1.5), config);
  for (const double v : speeds) {
    world.setVelocity("slide", v);
    world.step(10);  // its effort limit lets it change by 0.3 m/s in a step
    const double dry = 6.0 + 2.0 * std::exp(-v * v / 0.25);
    EXPECT_NEAR(world.jointEfforts()[0], (v > 0.0 ? dry : -dry) + 1.5 * v, 1e-12) << v;
  }
}

double stribeckDistance(double period_s) {
  MultibodyWorld world(stribeckModel(), weightless(period_s));
  world.setJointVelocities(vectorOf({1.0}));
  world.step(static_cast<int>(std::lround(1.0 / period_s)));
  EXPECT_EQ(world.jointVelocities()[0], 0.0);
  return world.jointPositions()[0];
}

TEST(Stribeck, ABlockStopsAfterTheDistanceOfTheClosedFormAndTheErrorHalvesWithThePeriod) {
  // m v dv / ds = -(6 + 2 exp(-u)) with u = (v / 0.5)^2, which is 4 at 1 m/s.
  const double expected = kMass * 0.25 / 12.0 * std::log((6.0 * std::exp(4.0) + 2.0) / 8.0);
  const double coarse = stribeckDistance(1e-3) - expected;
  const double fine = stribeckDistance(5e-4) - expected;
  EXPECT_LT(std::abs(coarse), 1e-3);        // one period at the initial velocity
  EXPECT_NEAR(fine / coarse, kHalf, 0.02);  // the last period ends at rest
}

double dampedVelocity(double period_s) {
  MultibodyWorld world(sliderModel(0.0, 4.0), weightless(period_s));
  world.setJointVelocities(vectorOf({2.0}));
  world.step(static_cast<int>(std::lround(1.0 / period_s)));
  return world.jointVelocities()[0];
}

TEST(Damping, VelocityDecaysExponentiallyAndTheErrorHalvesWithThePeriod) {
  const double expected = 2.0 * std::exp(-4.0 / kMass);
  const double coarse = dampedVelocity(1e-3) - expected;
  const double fine = dampedVelocity(5e-4) - expected;
  EXPECT_LT(std::abs(coarse), expected * 1e-3 * std::pow(4.0 / kMass, 2));  // dt (c/m)^2 t: the first-order term
  EXPECT_NEAR(fine / coarse, kHalf, kSecondOrder);
}

TEST(Damping, IsStableHoweverStrong) {
  MultibodyWorld world(sliderModel(0.0, 1e6), weightless());
  world.setJointVelocities(vectorOf({2.0}));
  world.step();
  EXPECT_NEAR(world.jointVelocities()[0], 2.0 / (1.0 + 0.001 * 1e6 / kMass), 1e-14);
}

TEST(Stops, AreReachedExactlyWithoutBounceAndLeftFreely) {
  MultibodyWorld world(sliderModel(0.0, 0.0, 0.5), withEffort());
  world.setJointVelocities(vectorOf({3.0}));
  double farthest = 0.0;
  for (int i = 0; i < 500; ++i) {
    world.step();
    farthest = std::max(farthest, world.jointPositions()[0]);
  }
  EXPECT_EQ(farthest, 0.5);
  EXPECT_EQ(world.jointPositions()[0], 0.5);
  EXPECT_EQ(world.jointVelocities()[0], 0.0);
  world.setEffort("slide", 100.0);
  world.step(100);
  EXPECT_EQ(world.jointPositions()[0], 0.5);
  EXPECT_EQ(world.jointEfforts()[0], 100.0);
  world.setEffort("slide", -3.0);
  world.step(1000);
  EXPECT_NEAR(world.jointVelocities()[0], -1.0, 1000 * 10 * kEps);
}

TEST(Stops, ALockedJointStays) {
  std::string urdf = replaced(readUrdf("slider.urdf"), "lower=\"-100\" upper=\"100\"", "lower=\"0.2\" upper=\"0.2\"");
  MultibodyWorld world(modelOf(urdf), withEffort());
  world.setEffort("slide", 500.0);
  world.step(10);
  EXPECT_EQ(world.jointPositions()[0], 0.2);
  EXPECT_EQ(world.jointVelocities()[0], 0.0);
}

TEST(EffortLimit, BoundsTheEffortAndTheAcceleration) {
  WorldConfig config = weightless();
  config.controllers = {controllerOf("slide", ControllerType::kEffortPosition, PidGains{1e6, 0.0, 1e3, 0.0, 0.0})};
  MultibodyWorld world(sliderModel(0.0, 0.0, 100.0, 12.0), config);
  world.setPosition("slide", 50.0);
  world.step(100);
  EXPECT_EQ(world.jointEfforts()[0], 12.0);
  EXPECT_NEAR(world.jointVelocities()[0], 0.1 * 12.0 / kMass, 100 * 10 * kEps);
}

TEST(VelocityLimit, IsReachedAndNotExceededByTheImplicitDrive) {
  MultibodyWorld world(sliderModel(0.0, 0.0, 100.0, 1000.0, 2.5), withEffort());
  world.setEffort("slide", 300.0);
  for (int i = 0; i < 200; ++i) {
    world.step();
    ASSERT_LE(world.jointVelocities()[0], 2.5);
  }
  EXPECT_EQ(world.jointVelocities()[0], 2.5);
  EXPECT_NEAR(world.jointEfforts()[0], 0.0, 1e-9);  // nothing resists: rounding of 3 kg * 2.5 m/s / 1 ms
}

TEST(VelocityLimit, EffortThatBrakesAnOverspeedingJointStillActs) {
  MultibodyWorld world(sliderModel(0.0, 0.0, 100.0, 1000.0, 2.5), withEffort());
  world.setJointVelocities(vectorOf({4.0}));
  world.setEffort("slide", 30.0);
  world.step(10);
  EXPECT_EQ(world.jointVelocities()[0], 4.0);  // no effort in that direction, no resistance either
  EXPECT_EQ(world.jointEfforts()[0], 0.0);
  world.setEffort("slide", -30.0);
  world.step(10);
  EXPECT_NEAR(world.jointVelocities()[0], 4.0 - 0.01 * 30.0 / kMass, 10 * 40 * kEps);
}

TEST(VelocityLimit, ExplicitDriveCutsTheEffortOnceTheLimitIsExceeded) {
  WorldConfig config = withEffort();
  config.drive = Drive::kExplicit;
  MultibodyWorld world(sliderModel(0.0, 0.0, 100.0, 1000.0, 2.5), config);
  world.setEffort("slide", 300.0);
  world.step(26);
  EXPECT_GT(world.jointVelocities()[0], 2.5);
  world.step();
  EXPECT_EQ(world.jointEfforts()[0], 0.0);
}

TEST(EffortBoundsOf, FollowsJointLimitsInterface) {
  JointLimits limits;
  limits.has_position = limits.has_effort = limits.has_velocity = true;
  limits.lower = -1.0;
  limits.upper = 1.0;
  limits.effort = 10.0;
  limits.velocity = 2.0;
  struct Case {
    double q, v, min, max;
  };
  for (const Case& each : {Case{0, 0, -10, 10}, Case{1.1, 0, -10, 0}, Case{-1.1, 0, 0, 10}, Case{0, 2.1, -10, 0},
                           Case{0, -2.1, 0, 10}, Case{1.1, -2.1, 0, 0}, Case{1.0, 2.0, -10, 10}}) {
    const EffortBounds bounds = effortBounds(limits, each.q, each.v);
    EXPECT_EQ(bounds.min, each.min) << each.q << " " << each.v;
    EXPECT_EQ(bounds.max, each.max) << each.q << " " << each.v;
  }
  EXPECT_EQ(clampPosition(limits, 3.0), 1.0);
  EXPECT_EQ(clampVelocity(limits, -3.0), -2.0);
  EXPECT_EQ(effortBounds(JointLimits{}, 0.0, 0.0).max, std::numeric_limits<double>::infinity());
}

}  // namespace
}  // namespace aras_visual_servo_sim::friction_and_limits_test
