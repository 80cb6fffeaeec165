// What fuzzing found: numbers that no true sender and no true record has.
#include <limits>

#include "aras_visual_servo_sim/config/archive.hpp"
#include "aras_visual_servo_sim/simulation/state/run_hash.hpp"
#include "tools/pan_lift.hpp"
#include "tools/physics_tools.hpp"

namespace aras_visual_servo_sim::forged_test {
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

/** A saved state with the number at `place` replaced, its checksum put right. */
std::string forged(std::string state, std::size_t place, std::int64_t number) {
  state.resize(state.size() - sizeof(std::uint64_t));
  std::memcpy(state.data() + place, &number, sizeof(number));
  RunHash hash;
  hash.add(state.data(), state.size());
  const std::uint64_t sum = hash.state();
  return state.append(reinterpret_cast<const char*>(&sum), sizeof(sum));
}

// Frames of 30 Hz are at the periods 0, 34, 67, ...: after 40 periods the next one is the third, which has the index 2.
TEST(Forged, ANextFrameIsNeitherPastNorFurtherAwayThanTheNext) {
  Simulation simulation = fixture::panLift();
  simulation.step(40);
  const std::string state = simulation.saveState();
  std::uint64_t world = 0;
  std::memcpy(&world, state.data() + 16, sizeof(world));
  const std::size_t place = 16 + 8 + world + 8 + 8 + 8 + 8;  // magic, time, world, hash, refusals, number of cameras
  simulation.step(100);
  const std::string later = simulation.saveState();
  for (const std::int64_t next : {std::int64_t{-1}, std::int64_t{1}, std::int64_t{3},
                                  std::numeric_limits<std::int64_t>::max(), std::numeric_limits<std::int64_t>::min()}) {
    EXPECT_HAS(messageOf<StateError>([&] { simulation.restoreState(forged(state, place, next)); }),
               "camera 'camera': found the next frame " + std::to_string(next) + ", allowed 2 or 2");
    EXPECT_EQ(simulation.saveState(), later) << next;
  }
  simulation.restoreState(forged(state, place, 2));
  EXPECT_EQ(simulation.saveState(), state);
}

TEST(Forged, ATimeIsWithinThirtyYears) {
  Simulation simulation = fixture::panLift();
  simulation.step(34);
  const std::string state = simulation.saveState();
  const std::size_t place = 8;  // behind magic
  for (const std::int64_t forgery : {std::int64_t{-1}, std::int64_t{1000000000001}}) {
    EXPECT_HAS(messageOf<StateError>([&] { simulation.restoreState(forged(state, place, forgery)); }),
               "found period " + std::to_string(forgery) + ", allowed 0 to 1000000000000");
    EXPECT_EQ(simulation.saveState(), state) << forgery;
  }
}

TEST(Forged, ADescriptionThatIsNoYamlNamesItsModel) {
  Simulation simulation = fixture::panLift();
  simulation.spawnModel(YAML::Load("{name: ball, sphere_m: 0.125}"));
  const std::string state = simulation.saveState();
  const std::size_t place = state.find("0.125");
  ASSERT_NE(place, std::string::npos);
  std::int64_t bytes = 0;
  std::memcpy(&bytes, state.data() + place, sizeof(bytes));
  std::memcpy(&bytes, "\"\\(\"}", 5);  // there is no such escape
  EXPECT_HAS(messageOf<StateError>([&] { simulation.restoreState(forged(state, place, bytes)); }),
             "saved state: description of model 'ball': yaml-cpp: error at line 1");
  EXPECT_EQ(simulation.saveState(), state);
}

TEST(Forged, ATruthValueOfASavedWorldIsTrueOrFalse) {
  const std::string bytes("\x07\x00\x01", 3);
  Archive archive(bytes);
  for (const bool expected : {true, false, true}) {
    bool value = !expected;
    archive(value);
    unsigned char held = 0;
    std::memcpy(&held, &value, 1);
    EXPECT_EQ(held, expected ? 1 : 0);
  }
}

}  // namespace
}  // namespace aras_visual_servo_sim::forged_test
