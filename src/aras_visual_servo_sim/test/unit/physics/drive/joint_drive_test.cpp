// The drive of one joint by itself: what it takes, what it asks for at a state, what it shows of it.
#include "physics/drive/joint_drive.hpp"

#include "tools/physics_tools.hpp"

namespace aras_visual_servo_sim::joint_drive_test {
namespace {

constexpr double kDt = 0.01;
constexpr double kLower = -1.0, kUpper = 1.5, kVelocity = 2.0, kEffort = 10.0;
constexpr double kRounding = 1e-12;  // of a few sums of numbers of this size

Joint slide() {
  Joint joint;
  joint.name = "slide";
  joint.type = JointType::kPrismatic;
  joint.limits.has_position = joint.limits.has_velocity = joint.limits.has_effort = true;
  joint.limits.lower = kLower;
  joint.limits.upper = kUpper;
  joint.limits.velocity = kVelocity;
  joint.limits.effort = kEffort;
  joint.enforced = joint.limits;
  return joint;
}

/** A drive of this type, started at q = 0. */
JointDrive driveOf(ControllerType type, const PidGains& gains = {}, Drive when = Drive::kImplicit,
                   const Joint& joint = slide()) {
  const ControllerConfig controller = controllerOf(joint.name, type, gains);
  JointDrive drive(joint, &controller, when, kDt);
  drive.start(0.0);
  return drive;
}

JointGraph graphAt(JointDrive& drive, double q = 0.0, double v = 0.0, std::int64_t tick = 0) {
  JointGraph graph;
  drive.prepare(q, v, tick, graph);
  return graph;
}

/** Velocity that a servo wants at the end of a period that begins at this state. */
double servoVelocity(JointDrive& drive, double q = 0.0, double v = 0.0) {
  const JointGraph graph = graphAt(drive, q, v);
  bool vertical = false;
  return graph.point(graph.locate(v, vertical));
}

TEST(JointDrive, TakesWhatItsTypeIsCommandedIn) {
  struct Case {
    ControllerType type;
    bool position, velocity, effort;
  };
  for (const Case& each :
       {Case{ControllerType::kEffortPosition, true, true, false}, Case{ControllerType::kPosition, true, true, false},
        Case{ControllerType::kEffortVelocity, false, true, false}, Case{ControllerType::kVelocity, false, true, false},
        Case{ControllerType::kEffort, false, false, true}}) {
    SCOPED_TRACE(controllerTypeName(each.type));
    JointDrive drive = driveOf(each.type);
    EXPECT_EQ(drive.takesPosition(), each.position);
    EXPECT_EQ(drive.takesVelocity(), each.velocity);
    EXPECT_EQ(drive.takesEffort(), each.effort);
    drive.release();
    EXPECT_FALSE(drive.takesPosition() || drive.takesVelocity() || drive.takesEffort());
  }
}

TEST(JointDrive, KeepsNothingOfAControllerThatReleasedIt) {
  JointDrive drive = driveOf(ControllerType::kVelocity, PidGains{3.0, 0.0, 0.0, 0.0, 0.0, false});
  drive.release();
  EXPECT_EQ(drive.controller().gains.p, 0.0);
  EXPECT_TRUE(drive.controller().name.empty());
}

TEST(JointDrive, OfAVelocityJointWithSoftLimitsNeedsNoOtherLimits) {
  Joint joint = slide();
  joint.soft.present = true;
  joint.enforced.has_velocity = joint.enforced.has_effort = false;
  EXPECT_NO_THROW(driveOf(ControllerType::kVelocity, {}, Drive::kImplicit, joint));
}

TEST(JointDrive, AimsWithinTheLimitsOfItsQuantity) {
  for (const double sign : {-1.0, 1.0}) {
    const JointTarget far{sign * 7.0, 0.0, kEffort};
    JointDrive position = driveOf(ControllerType::kPosition);
    position.aim(far);
    EXPECT_EQ(position.memory().set_point, sign > 0.0 ? kUpper : kLower);
    JointDrive velocity = driveOf(ControllerType::kVelocity);
    velocity.aim(far);
    EXPECT_EQ(velocity.memory().set_point, sign * kVelocity);
    JointDrive effort = driveOf(ControllerType::kEffort);
    effort.aim(far);
    EXPECT_EQ(effort.memory().set_point, sign * 7.0);
  }
}

TEST(JointDrive, AddsTheFeedForwardOfAnAimWithinTheAimsEffortLimit) {
  JointDrive drive = driveOf(ControllerType::kEffortPosition);  // no gains: nothing else acts
  for (const double sign : {-1.0, 1.0}) {
    drive.aim({0.0, sign * 6.0, kEffort});
    EXPECT_EQ(graphAt(drive).actuatorEffort(0.0, 0.0), sign * 6.0);
    drive.aim({0.0, sign * 6.0, 4.0});
    EXPECT_EQ(graphAt(drive).actuatorEffort(0.0, 0.0), sign * 4.0);
  }
}

/** The error that a drive sees at q: the effort of an explicit one whose gain is 1. */
double errorSeen(JointType type, double limit, double q, double set_point) {
  Joint joint = slide();
  joint.type = type;
  joint.limits.has_position = type != JointType::kContinuous;
  joint.limits.lower = -limit;
  joint.limits.upper = limit;
  joint.enforced.has_position = joint.enforced.has_effort = false;
  JointDrive drive =
      driveOf(ControllerType::kEffortPosition, PidGains{1.0, 0.0, 0.0, 0.0, 0.0, false}, Drive::kExplicit, joint);
  drive.commandPosition(set_point);
  return graphAt(drive, q).actuatorEffort(0.0, 0.0);
}

TEST(JointDrive, GoesTheShorterWayRoundWhereThereIsOne) {
  EXPECT_NEAR(errorSeen(JointType::kContinuous, 0.0, 3.0, -3.0), 2.0 * kPi - 6.0, kRounding);
  EXPECT_NEAR(errorSeen(JointType::kContinuous, 0.0, -3.0, 3.0), 6.0 - 2.0 * kPi, kRounding);
  EXPECT_NEAR(errorSeen(JointType::kRevolute, 7.0, 3.0, -3.0), 2.0 * kPi - 6.0, kRounding);
  EXPECT_EQ(errorSeen(JointType::kPrismatic, 7.0, 3.0, -3.0), -6.0);
  EXPECT_EQ(errorSeen(JointType::kPrismatic, 7.0, -3.0, 3.0), 6.0);
}

TEST(JointDrive, OfLessThanATurnReachesItsLimitsFromEverywhere) {
  for (int k = -300; k <= 300; ++k) {
    const double q = 0.01 * k;
    EXPECT_EQ(errorSeen(JointType::kRevolute, 3.1, q, 3.1), 3.1 - q);
    EXPECT_EQ(errorSeen(JointType::kRevolute, 3.1, q, -3.1), -3.1 - q);
  }
}

TEST(JointDrive, StartsWhereTheJointIsWithinItsLimitsAndKeepsItsGains) {
  JointDrive drive = driveOf(ControllerType::kEffortPosition);
  drive.memory().gains.p = 7.0;
  for (const auto& [q, set_point] : {std::pair{0.4, 0.4}, {9.0, kUpper}, {-9.0, kLower}}) {
    drive.start(q);
    EXPECT_EQ(drive.memory().set_point, set_point);
    EXPECT_EQ(drive.memory().process_value, q);
    EXPECT_EQ(drive.memory().gains.p, 7.0);
  }
  JointDrive velocity = driveOf(ControllerType::kEffortVelocity);
  velocity.start(0.4);
  EXPECT_EQ(velocity.memory().set_point, 0.0);
  EXPECT_EQ(velocity.memory().process_value, 0.0);
}

TEST(JointDrive, AVelocityMovesASetPointUpToItsLastTickAndIsForgotten) {
  for (const double sign : {-1.0, 1.0}) {
    JointDrive drive = driveOf(ControllerType::kPosition);
    drive.commandVelocity(sign * 7.0, 3);
    for (int tick = 0; tick < 6; ++tick) {
      graphAt(drive, 0.0, 0.0, tick);
      EXPECT_NEAR(drive.memory().set_point, sign * kVelocity * kDt * std::min(tick + 1, 3), kRounding);
    }
    EXPECT_EQ(drive.memory().velocity_command, 0.0);
    drive.commandVelocity(sign * 7.0, kNever);
    for (int tick = 6; tick < 100; ++tick) graphAt(drive, 0.0, 0.0, tick);
    EXPECT_EQ(drive.memory().set_point, sign > 0.0 ? kUpper : kLower);
  }
}

TEST(JointDrive, VelocitiesAndEffortsEndAtTheirTick) {
  for (const double sign : {-1.0, 1.0}) {
    JointDrive velocity = driveOf(ControllerType::kVelocity);
    velocity.commandVelocity(sign * 7.0, 3);
    JointDrive effort = driveOf(ControllerType::kEffort);
    effort.commandEffort(sign * 5.0, 3);
    for (int tick = 0; tick < 5; ++tick) {
      graphAt(velocity, 0.0, 0.0, tick);
      EXPECT_EQ(velocity.memory().set_point, tick < 3 ? sign * kVelocity : 0.0);
      EXPECT_EQ(graphAt(effort, 0.0, 0.0, tick).actuatorEffort(0.0, 0.0), tick < 3 ? sign * 5.0 : 0.0);
    }
  }
}

/** Effort of an implicit PID on the position, 0.1 from its set-point, at a velocity at the end of the period. */
double pidEffort(const PidGains& gains, double v, double error = 0.1, const PidState& state = {0, 0, 0, 0, 0, true}) {
  JointDrive drive = driveOf(ControllerType::kEffortPosition, gains);
  drive.commandPosition(error);
  drive.memory().pid = state;
  return graphAt(drive).actuatorEffort(v, 0.0);
}

TEST(JointDrive, AnImplicitPidSeesTheErrorAtTheEndOfThePeriod) {
  for (const double v : {-1.0, 0.0, 1.0}) {
    const double error = 0.1 - kDt * v;
    EXPECT_NEAR(pidEffort({20.0, 0.0, 0.0, 0.0, 0.0, false}, v), 20.0 * error, kRounding);
    EXPECT_NEAR(pidEffort({0.0, 0.0, 0.5, 0.0, 0.0, false}, v, 0.1, {0, 0.02, 0, 0, 0, true}),
                0.5 * (error - 0.02) / kDt, kRounding);
    EXPECT_NEAR(pidEffort({0.0, 900.0, 0.0, -9.0, 9.0, false}, v, 0.1, {0, 0, 0, 0.002, 0, true}),
                900.0 * (0.002 + kDt * error), kRounding);
    EXPECT_NEAR(pidEffort({0.0, 0.0, 0.5, 0.0, 0.0, false}, v, 0.1, {0, 0, 4.0, 0, 0, false}), 0.5 * 4.0, kRounding);
  }
}

TEST(JointDrive, AnImplicitIntegralHasBothItsBounds) {
  EXPECT_EQ(pidEffort({0.0, 9000.0, 0.0, -2.0, 3.0, false}, 0.0, 0.1), 3.0);
  EXPECT_EQ(pidEffort({0.0, 9000.0, 0.0, -2.0, 3.0, false}, 0.0, -0.1), -2.0);
}

TEST(JointDrive, AnImplicitPidOnVelocitySeesTheVelocityAtTheEndOfThePeriod) {
  JointDrive drive = driveOf(ControllerType::kEffortVelocity, PidGains{2.0, 0.0, 0.0, 0.0, 0.0, false});
  drive.commandVelocity(1.0, kNever);
  for (const double v : {-0.5, 0.0, 1.5})
    EXPECT_NEAR(graphAt(drive).actuatorEffort(v, 0.0), 2.0 * (1.0 - v), kRounding);
}

TEST(JointDrive, AServoKeepsVelocityAndAccelerationLimitsInBothDirections) {
  Joint joint = slide();
  joint.enforced.has_acceleration = true;
  joint.enforced.acceleration = 20.0;
  for (const double sign : {-1.0, 1.0}) {
    JointDrive position = driveOf(ControllerType::kPosition, {}, Drive::kImplicit, joint);
    position.commandPosition(sign * 0.9);
    EXPECT_EQ(servoVelocity(position), sign * kVelocity);
    JointDrive velocity = driveOf(ControllerType::kVelocity, {}, Drive::kImplicit, joint);
    velocity.commandVelocity(sign * 1.5, kNever);
    EXPECT_NEAR(servoVelocity(velocity, 0.0, sign * 0.3), sign * 0.5, kRounding);
  }
}

TEST(JointDrive, SoftLimitsDoNotBoundTheEffortOfAServo) {
  Joint joint = slide();
  joint.soft = SoftLimits{true, 12.0, 25.0, -0.9, 1.4};
  joint.enforced.has_effort = false;
  JointDrive drive = driveOf(ControllerType::kPosition, {}, Drive::kImplicit, joint);
  const JointGraph graph = graphAt(drive);  // at rest
  for (const double effort : {-50.0, 50.0}) EXPECT_EQ(graph.actuatorEffort(0.0, effort), effort);
}

TEST(JointDrive, ASoftlyLimitedServoGoesOnFromItsCommandWhereTheJointLagsBehind) {
  Joint joint = slide();
  joint.soft = SoftLimits{true, 12.0, 25.0, -0.9, 1.4};
  for (const double sign : {-1.0, 1.0}) {
    JointDrive drive = driveOf(ControllerType::kPosition, {}, Drive::kImplicit, joint);
    drive.commandPosition(sign * 0.5);
    for (int k = 0; k < 3; ++k) graphAt(drive);  // held at 0 while the command moves on
    EXPECT_NEAR(servoVelocity(drive, sign * 0.07), sign * (4 * kVelocity * kDt - 0.07) / kDt, kRounding * 1e2);
  }
}

TEST(JointDrive, AnImplicitEffortMayActOnceAJointThatWasTooFastIsSlower) {
  for (const double sign : {-1.0, 1.0}) {
    JointDrive drive = driveOf(ControllerType::kEffort);
    drive.commandEffort(sign * 5.0, kNever);
    const JointGraph graph = graphAt(drive, 0.0, sign * 2.1);
    EXPECT_EQ(graph.actuatorEffort(sign * 1.9, 0.0), sign * 5.0);
    EXPECT_EQ(graph.actuatorEffort(sign * 2.05, 0.0), 0.0);
  }
}

TEST(JointDrive, StopsAreWhereTheLimitsAre) {
  JointDrive drive = driveOf(ControllerType::kEffort);
  const JointGraph graph = graphAt(drive, 0.2);
  EXPECT_NEAR(graph.point(0), (kLower - 0.2) / kDt, kRounding * 1e2);
  EXPECT_NEAR(graph.point(graph.points() - 1), (kUpper - 0.2) / kDt, kRounding * 1e2);
}

void expectShown(const JointDrive& drive, double value, double value_dot, double error, double command) {
  EXPECT_NEAR(drive.memory().process_value, value, kRounding);
  EXPECT_NEAR(drive.memory().process_value_dot, value_dot, kRounding * 1e2);
  EXPECT_NEAR(drive.memory().error, error, kRounding);
  EXPECT_NEAR(drive.memory().command, command, kRounding * 1e2);
}

TEST(JointDrive, ShowsTheStateAtTheEndOfThePeriod) {
  for (const Drive when : {Drive::kImplicit, Drive::kExplicit}) {
    SCOPED_TRACE(when == Drive::kImplicit);
    JointDrive position = driveOf(ControllerType::kPosition, {}, when);
    position.commandPosition(0.3);
    graphAt(position, 0.1, 1.0);
    position.finish(0.12, 2.0, 1.0);
    expectShown(position, 0.12, 2.0, 0.18, 0.3);
    JointDrive velocity = driveOf(ControllerType::kVelocity, {}, when);
    velocity.commandVelocity(0.5, kNever);
    graphAt(velocity, 0.1, 0.1);
    velocity.finish(0.12, 0.4, 0.1);
    expectShown(velocity, 0.4, 30.0, 0.1, 0.5);
    JointDrive effort = driveOf(ControllerType::kEffort, {}, when);
    effort.commandEffort(3.0, kNever);
    graphAt(effort, 0.1, 0.1);
    effort.finish(0.12, 0.4, 0.1);
    expectShown(effort, 0.12, 0.4, 0.0, 3.0);
  }
}

}  // namespace
}  // namespace aras_visual_servo_sim::joint_drive_test
