#include "aras_visual_servo_sim/simulation/time/lockstep_gate.hpp"

#include <gtest/gtest.h>

namespace aras_visual_servo_sim::lockstep_gate_test {
namespace {

TEST(LockstepGate, RunsFreeUntilTheFirstCommand) {
  LockstepGate gate(true);
  gate.imageSent(10);
  EXPECT_FALSE(gate.holding());
  gate.commandReceived(0);
  gate.imageSent(20);
  EXPECT_TRUE(gate.holding());
}

TEST(LockstepGate, NeverHoldsWhenDisabled) {
  LockstepGate gate(false);
  gate.commandReceived(0);
  gate.imageSent(10);
  EXPECT_FALSE(gate.holding());
}

TEST(LockstepGate, ReleasesOnACommandStampedAtOrAfterTheImageOnly) {
  LockstepGate gate(true);
  gate.commandReceived(0);
  gate.imageSent(20);
  gate.commandReceived(19);
  EXPECT_TRUE(gate.holding());
  gate.commandReceived(20);
  EXPECT_FALSE(gate.holding());
}

TEST(LockstepGate, CommandSentBeforeTheImageDoesNotAnswerIt) {
  LockstepGate gate(true);
  gate.commandReceived(0);
  gate.imageSent(0);
  EXPECT_TRUE(gate.holding());
}

TEST(LockstepGate, EveryNamedNodeAnswersEveryImage) {
  LockstepGate gate(true, {"/b", "/a"});
  gate.commandReceived(0, "/stranger");
  EXPECT_FALSE(gate.armed());
  gate.commandReceived(0, "/a");
  gate.imageSent(10);
  EXPECT_EQ(gate.missing(), (std::set<std::string>{"/a", "/b"}));
  gate.commandReceived(10, "/a");
  gate.commandReceived(10, "/stranger");
  gate.commandReceived(9, "/b");
  EXPECT_EQ(gate.missing(), std::set<std::string>{"/b"});
  EXPECT_TRUE(gate.holding());
  gate.commandReceived(10, "/b");
  EXPECT_FALSE(gate.holding());
  gate.imageSent(20);
  EXPECT_EQ(gate.missing().size(), 2U);
  gate.reset();
  EXPECT_FALSE(gate.holding());
  EXPECT_TRUE(gate.armed());
}

TEST(LockstepGate, ResetDisarms) {
  LockstepGate gate(true);
  gate.commandReceived(0);
  gate.imageSent(10);
  gate.reset();
  EXPECT_FALSE(gate.holding());
  EXPECT_FALSE(gate.armed());
}

}  // namespace
}  // namespace aras_visual_servo_sim::lockstep_gate_test
