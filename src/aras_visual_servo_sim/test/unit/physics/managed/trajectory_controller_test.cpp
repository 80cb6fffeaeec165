#include "aras_visual_servo_sim/physics/managed/trajectory_controller.hpp"

#include "aras_visual_servo_sim/config/errors.hpp"
#include "tools/two_joints.hpp"

namespace aras_visual_servo_sim::trajectory_controller_test {
namespace {

constexpr double kPeriodS = 0.001;
constexpr double kOnTheWay = 1e-9;  // of a position joint, which reaches its set-point at the end of each period

const char* const kEffort = R"(
type: effort_controllers/JointTrajectoryController
joints: [b, a]
gains: {a: {p: 4000, d: 90, i: 10, i_clamp: 5}, b: {p: 1000, d: 40}}
constraints: {goal_time: 0.5, a: {trajectory: 0.2, goal: 0.01}}
)";

/** A world with a trajectory controller that runs. */
struct Follower {
  explicit Follower(const std::string& interface, const std::string& more = "", const std::string& type = "revolute",
                    const std::string& parameters = "")
      : world(twoJoints(interface + "JointInterface", type), config()) {
    std::string lower = interface;
    lower[0] = static_cast<char>(std::tolower(lower[0]));
    const std::string yaml =
        parameters.empty() ? "type: " + lower + "_controllers/JointTrajectoryController\njoints: [b, a]\n" : parameters;
    world.loadController("arm", YAML::Load(yaml + more));
    world.switchControllers({"arm"}, {}, true);
  }
  static WorldConfig config() {
    WorldConfig config = weightless(kPeriodS);
    config.hold_idle_joints = true;
    return config;
  }
  TrajectoryController& arm() { return static_cast<TrajectoryController&>(world.runningController("arm")); }
  std::string follow(const Trajectory& trajectory) { return arm().follow(trajectory, now(), world.jointsOf(arm())); }
  std::string pursue(const Trajectory& trajectory, const GoalTolerances& tolerances = {}) {
    return arm().pursue(trajectory, tolerances, now(), world.jointsOf(arm()));
  }
  double now() const { return static_cast<double>(world.ticks()) * kPeriodS; }
  void run(double seconds) { world.step(static_cast<int>(std::lround(seconds / kPeriodS))); }
  double a() const { return world.jointPositions()[0]; }
  double b() const { return world.jointPositions()[1]; }

  MultibodyWorld world;
};

Trajectory to(double a, double b, double time_s) {
  return {{"a", "b"}, std::nullopt, {{{a, b}, {0.0, 0.0}, {}, time_s}}};
}

TEST(TrajectoryController, PositionJointsAreOnTheTrajectoryAtEveryStep) {
  Follower follower("Position");
  EXPECT_EQ(follower.follow(to(0.6, -0.4, 1.0)), "");
  for (const double t : {0.1, 0.37, 0.8}) {
    follower.run(t - follower.now());
    const auto desired = follower.arm().at(t);
    EXPECT_NEAR(follower.b(), desired[0].position, kOnTheWay) << t;
    EXPECT_NEAR(follower.a(), desired[1].position, kOnTheWay) << t;
    EXPECT_NEAR(follower.a(), 0.6 * (3 * t * t - 2 * t * t * t), kOnTheWay) << "a cubic from rest to rest";
  }
  follower.run(1.0);
  EXPECT_NEAR(follower.a(), 0.6, kOnTheWay);
  EXPECT_NEAR(follower.b(), -0.4, kOnTheWay);
}

TEST(TrajectoryController, EffortJointsFollowWithTheirGains) {
  Follower follower("Effort", "", "revolute", kEffort);
  follower.pursue(to(0.6, -0.4, 1.0));
  follower.run(0.5);
  EXPECT_EQ(follower.arm().goalState(), GoalState::kActive);
  EXPECT_NEAR(follower.a(), 0.3, 0.02);  // lag of the PID: velocity of 0.9 rad/s times damping over p
  follower.run(1.0);
  EXPECT_NEAR(follower.a(), 0.6, 1e-3);
  EXPECT_NEAR(follower.b(), -0.4, 1e-3);
  EXPECT_EQ(follower.arm().goalState(), GoalState::kSucceeded);
}

TEST(TrajectoryController, VelocityJointsFollowWithFeedForwardAndGains) {
  Follower follower("Velocity", "gains: {a: {p: 20}, b: {p: 20}}\nvelocity_ff: {a: 1, b: 1}\n");
  follower.follow(to(0.6, -0.4, 1.0));
  follower.run(0.5);
  EXPECT_NEAR(follower.a(), 0.3, 2e-3);  // one period late: 0.9 rad/s times 1 ms
  follower.run(1.0);
  EXPECT_NEAR(follower.a(), 0.6, 1e-6);
  EXPECT_NEAR(follower.b(), -0.4, 1e-6);
}

TEST(TrajectoryController, AGoalThatIsLeftIsAbortedAndTheReasonGiven) {
  Follower follower("Effort", "", "revolute", kEffort);
  follower.pursue(to(2.5, 0.0, 0.05));  // 100 N m cannot do it
  follower.run(0.2);
  EXPECT_EQ(follower.arm().goalState(), GoalState::kPathViolated);
  EXPECT_HAS(follower.arm().goalError(), "a path error 0.2");
}

TEST(TrajectoryController, AGoalMayLiftTolerancesOrTightenThem) {
  Follower follower("Effort", "", "revolute", kEffort);
  GoalTolerances loose;
  loose.path["a"] = {-1.0, 0.0, 0.0};
  follower.pursue(to(2.5, 0.0, 0.05), loose);
  follower.run(0.2);
  EXPECT_EQ(follower.arm().goalState(), GoalState::kActive);
  GoalTolerances tight = loose;  // of a, which is still on its way
  tight.goal["b"] = {1e-12, 0.0, 0.0};
  tight.goal_time_s = 0.01;
  follower.pursue(to(2.5, 0.1, 2.0), tight);
  follower.run(2.5);
  EXPECT_EQ(follower.arm().goalState(), GoalState::kGoalViolated);
  EXPECT_HAS(follower.arm().goalError(), "b goal error");
}

TEST(TrajectoryController, ANewTrajectoryTakesOverFromTheOldOneWithoutAJump) {
  Follower follower("Position");
  follower.pursue(to(1.0, 0.0, 1.0));
  follower.run(0.4);
  Trajectory next = to(0.2, 0.3, 1.0);
  next.start_s = 0.6;
  follower.follow(next);
  EXPECT_EQ(follower.arm().goalState(), GoalState::kPreempted);
  const double at_06 = 1.0 * (3 * 0.36 - 2 * 0.216);
  EXPECT_NEAR(follower.arm().at(0.6)[1].position, at_06, kOnTheWay) << "until then the old one is followed";
  EXPECT_NEAR(follower.arm().at(0.6 + 1e-9)[1].velocity, 6 * 0.6 * 0.4, 1e-6) << "the velocity is kept";
  double before = follower.a();
  for (int k = 0; k < 1300; ++k) {
    follower.world.step();
    EXPECT_LT(std::abs(follower.a() - before), 2.0 * kPeriodS) << follower.now();
    before = follower.a();
  }
  EXPECT_NEAR(follower.a(), 0.2, kOnTheWay);
}

TEST(TrajectoryController, StopsWhereItIsOrWithinItsTime) {
  Follower at_once("Position"), ramp("Position", "stop_trajectory_duration: 0.2\n");
  for (Follower* follower : {&at_once, &ramp}) {
    follower->pursue(to(1.0, 0.0, 1.0));
    follower->run(0.5);
    follower->arm().cancel(follower->now(), follower->world.jointsOf(follower->arm()));
    EXPECT_EQ(follower->arm().goalState(), GoalState::kPreempted);
    follower->run(0.5);
    EXPECT_EQ(follower->world.jointVelocities()[0], 0.0);
  }
  EXPECT_NEAR(at_once.a(), 0.5, kOnTheWay);
  EXPECT_GT(ramp.a(), 0.55);
  ramp.pursue({{"a", "b"}, std::nullopt, {}});  // no points: stop, too
  ramp.run(0.5);
  EXPECT_EQ(ramp.arm().goalState(), GoalState::kSucceeded);
}

TEST(TrajectoryController, JointsThatAreLeftOutGoOnIfTheyMay) {
  Follower partial("Position", "allow_partial_joints_goal: true\n");
  partial.follow(to(0.6, -0.4, 1.0));
  partial.run(0.5);
  partial.follow({{"b"}, std::nullopt, {{{0.5}, {}, {}, 0.3}}});
  partial.run(0.5);
  EXPECT_NEAR(partial.a(), 0.6, kOnTheWay);
  EXPECT_NEAR(partial.b(), 0.5, kOnTheWay);
  Follower whole("Position");
  EXPECT_HAS(messageOf<ParameterError>([&] {
               whole.follow({{"b"}, std::nullopt, {{{0.5}, {}, {}, 0.3}}});
             }),
             "found b, allowed are b, a, all of them");
  EXPECT_HAS(messageOf<ParameterError>([&] {
               partial.follow({{"b", "c"}, std::nullopt, {{{0, 0}, {}, {}, 0.3}}});
             }),
             "found b, c, allowed are b, a or some of them");
}

TEST(TrajectoryController, AJointWithoutEndTurnsTheShortWay) {
  Follower follower("Position", "", "continuous");
  follower.follow(to(0.0, 3.0, 1.0));
  follower.run(1.5);
  follower.follow(to(0.0, -3.0, 1.0));
  follower.run(1.5);
  EXPECT_NEAR(follower.b(), 2 * kPi - 3.0, kOnTheWay);
}

TEST(TrajectoryController, RefusesWhileItDoesNotRun) {
  Follower follower("Position");
  follower.world.switchControllers({}, {"arm"}, true);
  EXPECT_HAS(messageOf<ParameterError>([&] { follower.arm(); }), "Controller is not running");
}

TEST(TrajectoryController, ASavedStateGoesOnAsTheRunItWasTakenFrom) {
  Follower one("Effort", "", "revolute", kEffort);
  one.pursue(to(0.6, -0.4, 1.0));
  one.run(0.4);
  const std::string state = one.world.saveState();
  one.run(1.0);
  Follower other("Effort", "", "revolute", kEffort);
  other.world.switchControllers({}, {"arm"}, true);  // what runs is part of the state
  other.world.restoreState(state);
  other.run(1.0);
  EXPECT_EQ(one.world.saveState(), other.world.saveState());
  EXPECT_EQ(other.arm().goalState(), GoalState::kSucceeded);
}

}  // namespace
}  // namespace aras_visual_servo_sim::trajectory_controller_test
