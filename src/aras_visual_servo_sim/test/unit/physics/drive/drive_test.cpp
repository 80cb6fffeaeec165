#include <limits>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "tools/physics_tools.hpp"

namespace aras_visual_servo_sim::drive_test {
namespace {

constexpr double kMass = 3.0;
constexpr double kEps = 2.2e-16;
constexpr double kHalf = 0.5;
constexpr double kSecondOrder = 0.02;

RobotModel armModel() { return modelOf(readUrdf("six_joint_arm.urdf")); }

JointCommand armCommand() {
  return JointCommand{{{"gantry", 0.05}, {"J1", -0.1}, {"J2", 0.3}, {"J3", -0.2}, {"J5", 0.1}, {"J6", 0.15}}, {}, {}};
}

WorldConfig positionDrive(const PidGains& gains, double period_s = 0.001, Drive drive = Drive::kImplicit) {
  WorldConfig config = weightless(period_s);
  config.drive = drive;
  config.controllers = {controllerOf("slide", ControllerType::kEffortPosition, gains)};
  return config;
}

TEST(ImplicitDrive, PublishedGainsSettleAtOneMillisecond) {
  MultibodyWorld world(armModel(), publishedDrives());
  world.setCommand(armCommand());
  world.step(4000);
  for (int i = 0; i < 6; ++i) {
    const std::string& joint = world.model().joint_names[i];
    const ControllerState state = world.controllerState(joint + "_controller");
    // At rest the drive may be off by what friction, weight (15 N m at most) and a wound-up integral (20 N m) hold.
    const double friction = world.model().movingJoint(i).friction;
    EXPECT_LT(std::abs(state.error), (friction + 35.0) / state.gains.p) << joint;
    EXPECT_LT(std::abs(world.jointVelocities()[i]), 0.01) << joint;
  }
}

TEST(ImplicitDrive, ReportedCommandIsThePidOfTheStateAtTheEndOfTheStep) {
  const PidGains gains{400.0, 50.0, 30.0, -2.0, 2.0, false};
  MultibodyWorld world(sliderModel(1.0, 0.5), positionDrive(gains));
  Pid pid(gains);
  PidState primed;  // by the evaluation at the start, where the error is 0
  primed.last_error_valid = true;
  pid.setState(primed);
  world.setPosition("slide", 0.02);
  for (int i = 0; i < 500; ++i) {
    world.step();
    const ControllerState state = world.controllerState("slide_controller");
    const double error = 0.02 - world.jointPositions()[0];
    EXPECT_NEAR(state.error, error, 4 * kEps);
    const double command = pid.compute(state.error, 0.001);
    EXPECT_EQ(state.command, command);
    // The effort solved for is the same number up to the rounding of d / dt times the error.
    EXPECT_NEAR(world.jointEfforts()[0], command, 30.0 / 0.001 * 100 * kEps);
  }
}

TEST(ImplicitDrive, SettlesHoweverStiffWithoutDamping) {
  const double p = 1e9;
  MultibodyWorld world(sliderModel(0.0, 0.0, 100.0, 1e15, 1e15), positionDrive(PidGains{p, 0.0, 0.0, 0.0, 0.0, false}));
  world.setPosition("slide", 1.0);
  const int n = 10;
  world.step(n);
  // Backward Euler shrinks the error by sqrt(1 + dt^2 p / m) a step, about 18.
  EXPECT_NEAR(world.jointPositions()[0], 1.0, 2.0 * std::pow(1.0 + 1e-6 * p / kMass, -0.5 * n));
}

/** Position after half a second of the step response, without limits in the way. */
double response(double period_s, Drive drive) {
  MultibodyWorld world(sliderModel(0.0, 2.0, 100.0, 1e9, 1e9),
                       positionDrive(PidGains{120.0, 60.0, 12.0, -1e3, 1e3, false}, period_s, drive));
  world.setVelocity("slide", 0.4);  // a ramp: the derivative sees the motion of the set-point
  world.step(static_cast<int>(std::lround(0.5 / period_s)));
  return world.jointPositions()[0];
}

TEST(Drives, ImplicitAndExplicitAgreeInTheLimitAndTheirErrorsHalveWithThePeriod) {
  const double reference =
      2.0 * response(1e-5, Drive::kImplicit) - response(2e-5, Drive::kImplicit);  // error of second order in 2e-5
  for (const Drive drive : {Drive::kImplicit, Drive::kExplicit}) {
    const double coarse = response(1e-3, drive) - reference;
    const double fine = response(5e-4, drive) - reference;
    EXPECT_NEAR(fine / coarse, kHalf, kSecondOrder);
  }
}

TEST(ExplicitDrive, AppliesThePidOfTheStateAtTheBeginningOfTheStep) {
  MultibodyWorld world(sliderModel(),
                       positionDrive(PidGains{10.0, 0.0, 0.0, 0.0, 0.0, false}, 0.001, Drive::kExplicit));
  world.setPosition("slide", 0.5);
  world.step();
  EXPECT_EQ(world.jointEfforts()[0], 5.0);
  EXPECT_NEAR(world.jointVelocities()[0], 0.001 * 5.0 / kMass, 4 * kEps);
}

TEST(ExplicitDrive, SaysSoWhenItDiverges) {
  WorldConfig config = weightless();
  config.drive = Drive::kExplicit;
  // Each step multiplies the velocity by 1 - dt p / I, about -2e6.
  config.controllers = {
      controllerOf("swing", ControllerType::kEffortVelocity, PidGains{1e9, 0.0, 0.0, 0.0, 0.0, false})};
  MultibodyWorld world(modelOf(readUrdf("pendulum.urdf")), config);
  world.setJointVelocities(vectorOf({1.0}));
  EXPECT_HAS(messageOf<NotFiniteError>([&] { world.step(1000); }), "joint 'swing': velocity is");
}

TEST(VelocityController, ReachesItsSetPoint) {
  WorldConfig config = weightless();
  config.controllers = {
      controllerOf("slide", ControllerType::kEffortVelocity, PidGains{200.0, 400.0, 0.0, -50.0, 50.0, false})};
  MultibodyWorld world(sliderModel(2.0, 1.0), config);
  world.setVelocity("slide", 0.7);
  world.step(8000);
  // The slow mode is i / p = 2 / s: exp(-16) of the start is left.
  EXPECT_NEAR(world.jointVelocities()[0], 0.7, 0.7 * std::exp(-15.0));
  EXPECT_NEAR(world.jointEfforts()[0], 2.0 + 0.7 * 1.0, 1e-4);
}

TEST(PositionServo, IsThereAfterOneStepWithinTheVelocityLimit) {
  WorldConfig config = weightless();
  config.controllers = {controllerOf("slide", ControllerType::kPosition)};
  MultibodyWorld world(sliderModel(5.0, 1.0, 100.0, 1e6, 2.0), config);
  world.setPosition("slide", 0.001);
  world.step();
  EXPECT_NEAR(world.jointPositions()[0], 0.001, 2 * kEps);
  world.step();
  EXPECT_NEAR(world.jointVelocities()[0], 0.0, 1e-12);  // eps / dt
  world.setPosition("slide", 1.0);
  world.step(100);
  EXPECT_NEAR(world.jointPositions()[0], 0.201, 100 * kEps);
}

TEST(VelocityServo, HoldsItsVelocityAgainstFrictionAndGravity) {
  WorldConfig config;
  config.gravity_m_s2 = {-kGravity, 0.0, 0.0};
  config.controllers = {controllerOf("slide", ControllerType::kVelocity)};
  MultibodyWorld world(sliderModel(5.0), config);
  world.setVelocity("slide", 0.3);
  world.step(10);
  EXPECT_EQ(world.jointVelocities()[0], 0.3);
  EXPECT_NEAR(world.jointEfforts()[0], kMass * kGravity + 5.0, 1e-9);  // eps * m v / dt
}

TEST(ContinuousJoint, TakesTheShortestWayRound) {
  WorldConfig config = weightless();
  config.controllers = {
      controllerOf("swing", ControllerType::kEffortPosition, PidGains{50.0, 0.0, 20.0, 0.0, 0.0, false})};
  MultibodyWorld world(modelOf(readUrdf("pendulum.urdf")), config);
  world.reset(vectorOf({3.0}));
  world.setPosition("swing", -3.0);
  world.step(10000);
  EXPECT_NEAR(world.jointPositions()[0], 2.0 * kPi - 3.0, 1e-9);  // slowest mode 2.5 / s over 10 s
}

TEST(Commands, SetPointsAreClampedToTheLimits) {
  MultibodyWorld world(sliderModel(0.0, 0.0, 0.5), positionDrive(PidGains{10.0, 0, 1, 0, 0, false}));
  world.setPosition("slide", 7.0);
  EXPECT_EQ(world.controllerState("slide_controller").set_point, 0.5);
}

TEST(Commands, VelocityMovesTheSetPointUntilTheNextCommandOrTheTimeout) {
  WorldConfig config = positionDrive(PidGains{1000.0, 0, 100, 0, 0, false});
  config.command_timeout_s = 0.1;
  MultibodyWorld world(sliderModel(), config);
  const auto setPoint = [&] { return world.controllerState("slide_controller").set_point; };
  JointCommand both;
  both.position["slide"] = 0.2;
  both.velocity["slide"] = 0.5;
  world.setCommand(both);
  world.step(40);
  EXPECT_NEAR(setPoint(), 0.22, 40 * kEps);
  world.step(1000);
  EXPECT_NEAR(setPoint(), 0.25, 100 * kEps);  // 100 ms of 0.5 m/s, then it holds
  world.setVelocity("slide", -0.5);
  world.step(50);
  world.setPosition("slide", 0.1);
  world.step(50);
  EXPECT_EQ(setPoint(), 0.1);
}

TEST(Commands, AnIntegratedSetPointStopsAtTheLimit) {
  MultibodyWorld world(sliderModel(0.0, 0.0, 0.1), positionDrive(PidGains{1000.0, 0, 100, 0, 0, false}));
  world.setVelocity("slide", 1.0);
  world.step(500);
  EXPECT_EQ(world.controllerState("slide_controller").set_point, 0.1);
}

TEST(Commands, AFaultyOneIsRefusedWhole) {
  MultibodyWorld world(armModel(), publishedDrives());
  world.setCommand(armCommand());
  const std::string before = world.saveState();
  JointCommand bad;
  bad.position = {{"J1", 0.2}, {"J2", std::numeric_limits<double>::quiet_NaN()}};
  EXPECT_HAS(messageOf<NotFiniteError>([&] { world.setCommand(bad); }), "joint 'J2': position command is nan");
  bad.position = {{"J1", 0.2}, {"J4", 0.1}};
  EXPECT_HAS(messageOf<UnknownNameError>([&] { world.setCommand(bad); }), "joint 'J4' does not exist");
  bad.position = {{"J1", 0.2}};
  bad.effort = {{"J2", 1.0}};
  EXPECT_HAS(messageOf<ParameterError>([&] { world.setCommand(bad); }),
             "must be one its controller takes (effort_controllers/JointPositionController)");
  EXPECT_EQ(world.saveState(), before);
}

TEST(Commands, ControllerCommandMeansWhatTheTypeSays) {
  WorldConfig config = weightless();
  config.command_timeout_s = 0.01;
  config.controllers = {controllerOf("slide", ControllerType::kVelocity)};
  MultibodyWorld world(sliderModel(), config);
  world.setControllerCommand("slide_controller", 0.4);
  world.step(100);
  EXPECT_EQ(world.jointVelocities()[0], 0.4);  // a topic's command has no timeout
  EXPECT_HAS(messageOf<UnknownNameError>([&] { world.setControllerCommand("arm", 0.4); }), "allowed: slide_controller");
}

TEST(Gains, ChangeWhileRunningAndAreChecked) {
  MultibodyWorld world(sliderModel(), positionDrive(PidGains{10.0, 0, 1, 0, 0, false}));
  world.setGains("slide_controller", PidGains{20.0, 1.0, 2.0, -1.0, 1.0, true});
  EXPECT_EQ(world.controllerState("slide_controller").gains.p, 20.0);
  EXPECT_HAS(messageOf<ParameterError>([&] {
               world.setGains("slide_controller", PidGains{-1.0, 0, std::nan(""), 0, 0, false});
             }),
             "slide_controller.pid.d: found .nan, allowed >= 0");
  world.reset(vectorOf({0.0}));
  EXPECT_EQ(world.controllerState("slide_controller").gains.p, 10.0);
}

/** Drives the arm about for a while, the same way each time. */
void run(MultibodyWorld& world, int from, int to) {
  for (int k = from; k < to; ++k) {
    if (k % 33 == 0) {
      JointCommand command;
      command.velocity = {{"gantry", 0.2 * std::sin(0.1 * k)}, {"J2", 0.3 * std::cos(0.07 * k)}, {"J6", 1.0}};
      world.setCommand(command);
    }
    world.step();
  }
}

TEST(Determinism, TwoWorldsGiveTheSameBytes) {
  MultibodyWorld one(armModel(), publishedDrives());
  MultibodyWorld two(armModel(), publishedDrives());
  run(one, 0, 3000);
  run(two, 0, 3000);
  EXPECT_EQ(one.saveState(), two.saveState());
}

TEST(Determinism, ARestoredStateGoesOnWithTheSameBytes) {
  MultibodyWorld one(armModel(), publishedDrives());
  run(one, 0, 1000);
  one.setGains("J2_controller", PidGains{5000.0, 100.0, 100.0, -10.0, 10.0, true});
  const std::string state = one.saveState();
  run(one, 1000, 2000);
  MultibodyWorld two(armModel(), publishedDrives());
  run(two, 0, 321);
  two.restoreState(state);
  EXPECT_EQ(two.saveState(), state);
  run(two, 1000, 2000);
  EXPECT_EQ(one.saveState(), two.saveState());
}

TEST(Determinism, ResetLeavesNothingOfWhatWas) {
  MultibodyWorld fresh(armModel(), publishedDrives());
  MultibodyWorld used(armModel(), publishedDrives());
  run(used, 0, 777);
  const Eigen::VectorXd q = vectorOf({0.1, 0.2, -0.3, 0.4, 0.5, 0.6});
  fresh.reset(q);
  used.reset(q);
  EXPECT_EQ(fresh.saveState(), used.saveState());
  run(fresh, 0, 500);
  run(used, 0, 500);
  EXPECT_EQ(fresh.saveState(), used.saveState());
}

TEST(State, ForeignOrDamagedBytesAreRefused) {
  MultibodyWorld world(armModel(), publishedDrives());
  MultibodyWorld other(sliderModel(), weightless());
  const std::string state = world.saveState();
  EXPECT_THROW(world.restoreState(other.saveState()), StateError);
  EXPECT_THROW(world.restoreState(state.substr(1)), StateError);
  EXPECT_THROW(world.restoreState(""), StateError);
  EXPECT_EQ(world.saveState(), state);
}

TEST(State, PositionsOutsideTheLimitsOrOfTheWrongShapeAreRefused) {
  MultibodyWorld world(armModel(), publishedDrives());
  EXPECT_HAS(messageOf<ParameterError>([&] {
               world.setJointPositions({{"J1", 0.1}, {"gantry", 1.6}});
             }),
             "joint 'gantry': position is 1.6, must be in [-1.5, 1.5]");
  EXPECT_EQ(world.jointPositions(), Eigen::VectorXd::Zero(6));
  EXPECT_THROW(world.reset(vectorOf({0.0})), ShapeError);
  EXPECT_THROW(world.reset(Eigen::VectorXd::Constant(6, std::nan(""))), NotFiniteError);
  world.setJointPositions({{"J1", 0.1}});
  EXPECT_EQ(world.jointPositions()[0], 0.1);
  EXPECT_EQ(world.controllerState("J1_controller").set_point, 0.1);
}

TEST(WorldConfigOf, IsChecked) {
  WorldConfig config = weightless(0.0);
  config.command_timeout_s = -1.0;
  const std::string message = messageOf<ParameterError>([&] { MultibodyWorld(sliderModel(), config); });
  EXPECT_HAS(message, "period_s: found 0, allowed >= 1e-06 and <= 0.1");
  EXPECT_HAS(message, "command_timeout_s: found -1, allowed >= 0");
}

}  // namespace
}  // namespace aras_visual_servo_sim::drive_test
