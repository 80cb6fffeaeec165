// What fuzzing found: numbers that no true sender and no true record has.
#include <limits>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "physics/world/state_stream.hpp"
#include "tools/pan_lift.hpp"
#include "tools/physics_tools.hpp"

namespace aras_visual_servo_sim {
namespace {

TEST(Forged, AStampFromBeforeAllTimeIsTooOldAndOneAfterItInTheFuture) {
  Simulation simulation = fixture::panLift();
  simulation.step(10);
  JointCommand command;
  command.position["pan"] = 0.1;
  const auto refusal = [&](std::int64_t stamp_ns) {
    return messageOf<ParameterError>([&] { simulation.setCommand(command, stamp_ns); });
  };
  EXPECT_HAS(refusal(std::numeric_limits<std::int64_t>::min()), "command: stamp is 9223372036.85");
  EXPECT_HAS(refusal(std::numeric_limits<std::int64_t>::max()), "in the future");
  EXPECT_EQ(simulation.commands().refused(), 2u);
}

TEST(Forged, ATruthValueOfASavedWorldIsTrueOrFalse) {
  const std::string bytes("\x07\x00\x01", 3);
  StateReader reader(bytes, 0);
  for (const bool expected : {true, false, true}) {
    bool value = !expected;
    reader.value(value);
    unsigned char held = 0;
    std::memcpy(&held, &value, 1);
    EXPECT_EQ(held, expected ? 1 : 0);
  }
}

}  // namespace
}  // namespace aras_visual_servo_sim
