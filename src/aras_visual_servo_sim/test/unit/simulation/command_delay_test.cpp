// Commands that are on their way: when they act, what a refusal and a reset do to them, and that a saved state has
// them.
#include <gtest/gtest.h>

#include <string>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "tools/pan_lift.hpp"
#include "tools/physics_tools.hpp"

namespace aras_visual_servo_sim::command_delay_test {
namespace {

const std::string kDelayed = "{gravity_m_s2: [0, 0, 0], command_timeout_s: 0.05, command_delay_s: 0.02}";

JointCommand velocity(double value) {
  JointCommand command;
  command.velocity["pan"] = value;
  return command;
}

double setPoint(const Simulation& simulation) { return simulation.body().controllerState("pan_controller").set_point; }

TEST(CommandDelay, ACommandActsAfterItsDelayAndForItsWholeTime) {
  Simulation simulation = fixture::panLift(kDelayed);
  const double before = setPoint(simulation);
  simulation.setCommand(velocity(1.0));
  simulation.step(20);
  EXPECT_EQ(setPoint(simulation), before);
  simulation.step(1);
  EXPECT_GT(setPoint(simulation), before);
  simulation.step(200);
  // 0.05 s at 1 rad/s; one period more or less decides what the last step counts
  EXPECT_NEAR(setPoint(simulation) - before, 0.05, 0.001 + 1e-12);
}

TEST(CommandDelay, CommandsActInTheirOrderHoweverTheStepsAreCut) {
  Simulation whole = fixture::panLift(kDelayed), cut = fixture::panLift(kDelayed);
  for (Simulation* simulation : {&whole, &cut}) {
    simulation->setCommand(velocity(1.0));
    simulation->step(7);
    simulation->setCommand(velocity(-0.5));
  }
  whole.step(60);
  for (int k = 0; k < 60; ++k) cut.step(1);
  EXPECT_EQ(setPoint(whole), setPoint(cut));
  EXPECT_LT(setPoint(whole), 0.0) << "7 ms forwards, then half as fast back for 33 ms";
}

TEST(CommandDelay, ARefusedCommandTakesWithItWhatIsOnTheWay) {
  Simulation simulation = fixture::panLift(kDelayed);
  const double before = setPoint(simulation);
  simulation.setCommand(velocity(1.0));
  EXPECT_THROW(simulation.setCommand(velocity(1.0), simulation.timeNs() + 1), ParameterError) << "from the future";
  simulation.step(100);
  EXPECT_EQ(setPoint(simulation), before);
  JointCommand wrong;
  wrong.velocity["nose"] = 1.0;
  simulation.setCommand(wrong);
  EXPECT_EQ(simulation.commands().refused(), 1U);
  simulation.step(10);
  simulation.setCommand(velocity(1.0));
  simulation.step(100);  // the wrong one is looked at when it is due
  EXPECT_EQ(simulation.commands().refused(), 2U);
  EXPECT_HAS(simulation.commands().lastRefusal(), "nose");
  EXPECT_EQ(setPoint(simulation), before);
}

TEST(CommandDelay, AResetAndAPlacedArmForgetWhatIsOnTheWay) {
  Simulation simulation = fixture::panLift(kDelayed);
  simulation.setCommand(velocity(1.0));
  simulation.setJointPositions({{"pan", 0.0}});
  EXPECT_EQ(simulation.commands().nextDueNs(), Commands::kNeverNs);
  simulation.setCommand(velocity(1.0));
  simulation.reset();
  EXPECT_EQ(simulation.commands().nextDueNs(), Commands::kNeverNs);
}

TEST(CommandDelay, ASavedStateHasTheCommandsOnTheirWay) {
  Simulation simulation = fixture::panLift(kDelayed), other = fixture::panLift(kDelayed);
  simulation.setCommand(velocity(1.0));
  simulation.step(10);
  other.restoreState(simulation.saveState());
  for (Simulation* one : {&simulation, &other}) one->step(40);
  EXPECT_NE(setPoint(other), 0.0);
  EXPECT_EQ(setPoint(simulation), setPoint(other));
  Simulation prompt = fixture::panLift("{gravity_m_s2: [0, 0, 0]}");
  EXPECT_THROW(prompt.restoreState(simulation.saveState()), StateError) << "it has no place for such commands";
}

TEST(CommandDelay, IsRoundedUpToWholePeriodsAndNeverNegative) {
  Simulation simulation = fixture::panLift("{gravity_m_s2: [0, 0, 0], command_delay_s: 0.0031}");
  simulation.setCommand(velocity(1.0));
  EXPECT_EQ(simulation.commands().nextDueNs(), 4000000);
  EXPECT_THROW(fixture::panLift("{command_delay_s: -0.1}"), ParameterError);
}

}  // namespace
}  // namespace aras_visual_servo_sim::command_delay_test
