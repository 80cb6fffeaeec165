#include "aras_visual_servo_sim/lockstep_gate.hpp"

#include <gtest/gtest.h>

namespace aras_visual_servo_sim {
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

TEST(LockstepGate, ResetDisarms) {
  LockstepGate gate(true);
  gate.commandReceived(0);
  gate.imageSent(10);
  gate.reset();
  EXPECT_FALSE(gate.holding());
  EXPECT_FALSE(gate.armed());
}

}  // namespace
}  // namespace aras_visual_servo_sim
