#include "aras_visual_servo_sim/physics/managed/trajectory.hpp"

#include "aras_visual_servo_sim/config/errors.hpp"
#include "tools/physics_tools.hpp"

namespace aras_visual_servo_sim::trajectory_test {
namespace {

constexpr double kRounding = 1e-12;  // of some twenty operations on numbers near 1

const Knot kStart{0.3, -0.7, 1.1}, kEnd{1.9, 0.4, -2.3};

TEST(Segment, PassesThroughBothEnds) {
  const Segment segment(2.0, kStart, 3.5, kEnd);
  for (const auto& [time_s, knot] : {std::make_pair(2.0, kStart), std::make_pair(3.5, kEnd)}) {
    const TrajectoryState state = segment.at(time_s);
    EXPECT_NEAR(state.position, knot.position, kRounding);
    EXPECT_NEAR(state.velocity, *knot.velocity, 10 * kRounding);
    EXPECT_NEAR(state.acceleration, *knot.acceleration, 100 * kRounding);
  }
}

TEST(Segment, VelocityAndAccelerationAreTheDerivativesOfPosition) {
  constexpr double kStep = 1e-4, kTruncation = 1e-5;  // the error of central differences is of order step^2
  const Segment quintic(0.0, kStart, 1.5, kEnd);
  const Segment cubic(0.0, {0.3, -0.7, std::nullopt}, 1.5, {1.9, 0.4, std::nullopt});
  for (const Segment& segment : {quintic, cubic}) {
    for (const double t : {0.2, 0.71, 1.3}) {
      const auto before = segment.at(t - kStep), now = segment.at(t), after = segment.at(t + kStep);
      EXPECT_NEAR(now.velocity, (after.position - before.position) / (2 * kStep), kTruncation);
      EXPECT_NEAR(now.acceleration, (after.velocity - before.velocity) / (2 * kStep), kTruncation);
    }
  }
}

TEST(Segment, WithoutVelocitiesIsAStraightLine) {
  const Segment segment(0.0, kStart, 2.0, {1.3, std::nullopt, std::nullopt});
  EXPECT_NEAR(segment.at(0.5).position, 0.55, kRounding);
  EXPECT_NEAR(segment.at(0.5).velocity, 0.5, kRounding);
  EXPECT_EQ(segment.at(0.5).acceleration, 0.0);
}

TEST(Segment, RestsOutsideItsTime) {
  const Segment segment(2.0, kStart, 3.0, kEnd);
  EXPECT_EQ(segment.at(1.0).position, kStart.position);
  EXPECT_EQ(segment.at(1.0).velocity, 0.0);
  EXPECT_NEAR(segment.at(4.0).position, kEnd.position, kRounding);
  EXPECT_EQ(segment.at(4.0).velocity, 0.0);
}

TEST(StopRamp, BeginsWithTheVelocityAndEndsAtRest) {
  const Segment ramp = stopRamp(1.0, 0.2, 0.8, 0.5);
  EXPECT_NEAR(ramp.at(1.0).velocity, 0.8, kRounding);
  EXPECT_NEAR(ramp.at(1.5).velocity, 0.0, 10 * kRounding);
  EXPECT_GT(ramp.at(1.5).position, 0.2);
}

Trajectory twoPoints(double first_s, double second_s) {
  return {{"a"}, std::nullopt, {{{0.1}, {}, {}, first_s}, {{0.2}, {}, {}, second_s}}};
}

TEST(FirstPointAfter, DropsPointsOfThePastAndSaysSo) {
  Trajectory late = twoPoints(1.0, 2.0);
  late.start_s = 8.5;
  std::string note;
  EXPECT_EQ(firstPointAfter(late, 10.0, note), 1u);
  EXPECT_HAS(note, "Dropping first 1 trajectory point(s) out of 2");
}

TEST(FirstPointAfter, APointAtTheVeryStartIsDroppedSilently) {
  std::string note;
  EXPECT_EQ(firstPointAfter(twoPoints(0.0, 1.0), 10.0, note), 1u);
  EXPECT_EQ(note, "");
}

TEST(FirstPointAfter, RefusesWhatCannotBeFollowed) {
  std::string note;
  const auto refusal = [&note](const Trajectory& trajectory) {
    return messageOf<ParameterError>([&] { firstPointAfter(trajectory, 10.0, note); });
  };
  EXPECT_HAS(refusal(twoPoints(2.0, 1.0)), "not strictly increasing in time: 2 s, then 1 s");
  EXPECT_HAS(refusal(twoPoints(1.0, 1.0)), "not strictly increasing in time");
  Trajectory past = twoPoints(1.0, 2.0);
  past.start_s = 7.0;
  EXPECT_HAS(refusal(past), "Dropping all 2 trajectory point(s)");
  EXPECT_HAS(refusal(past), "1 s in the past");
  Trajectory bad = twoPoints(1.0, 2.0);
  bad.points[1].positions[0] = std::nan("");
  EXPECT_HAS(refusal(bad), "trajectory point 1: found a number that is not finite");
  bad = twoPoints(1.0, 2.0);
  bad.points[0].velocities = {0.0, 0.0};
  EXPECT_HAS(refusal(bad), "Size mismatch in trajectory point position, velocity or acceleration data");
}

TEST(TurnsBetween, BringsAnAngleNearTheOneBefore) {
  EXPECT_NEAR(-3.0 + turnsBetween(3.0, -3.0), 2 * kPi - 3.0, kRounding);
  EXPECT_EQ(turnsBetween(0.5, 1.0), 0.0);
}

}  // namespace
}  // namespace aras_visual_servo_sim::trajectory_test
