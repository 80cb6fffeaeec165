// What is said of a saved state that is whole, and yet none of this simulation.
#include <string>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "simulation/state/state_record.hpp"
#include "tools/pan_lift.hpp"
#include "tools/physics_tools.hpp"

namespace aras_visual_servo_sim {
namespace {

/** A whole record of what `put` writes. */
template <typename Put>
std::string record(const Put& put) {
  StateWriter out;
  put(out);
  return out.take();
}

TEST(StateRefusals, DamagedBytesAreCounted) {
  EXPECT_EQ(messageOf<StateError>([] { StateReader reader("abc"); }),
            "saved state: found 3 bytes that are damaged, cut short or none of save_state's");
  EXPECT_EQ(messageOf<StateError>([] { StateReader reader("abcdefgh"); }),
            "saved state: found 8 bytes that are damaged, cut short or none of save_state's");
}

TEST(StateRefusals, ARecordThatEndsEarlyIsRefused) {
  const std::string bytes = record([](StateWriter& out) { out.put<std::uint64_t>(1000); });
  StateReader reader(bytes);
  EXPECT_EQ(messageOf<StateError>([&] { reader.getText(); }),
            "saved state: found 8 bytes, allowed more: it ends early");
}

TEST(StateRefusals, AVectorHasASizeOfItsOwn) {
  const std::string bytes = record([](StateWriter& out) { out.putVector(Eigen::VectorXd::Zero(3)); });
  StateReader reader(bytes);
  EXPECT_EQ(messageOf<StateError>([&] { reader.getVector(2); }),
            "saved state: found a vector of 3 numbers, allowed 2 for this robot");
}

TEST(StateRefusals, APoseIsFinite) {
  Pose nowhere;
  nowhere.p.y() = std::nan("");
  Pose unturned;
  unturned.q.coeffs()[2] = std::numeric_limits<double>::infinity();
  for (const Pose& pose : {nowhere, unturned}) {
    const std::string bytes = record([&](StateWriter& out) { out.putPose(pose); });
    StateReader reader(bytes);
    EXPECT_EQ(messageOf<StateError>([&] { reader.getPose(); }), "saved state: a pose is not finite");
  }
}

TEST(StateRefusals, AnExposureIsOfAsManyModelsAsThereAre) {
  Moment moment;
  moment.bodies.resize(2);
  const std::string bytes = record([&](StateWriter& out) { out.putMoment(moment); });
  StateReader reader(bytes);
  EXPECT_EQ(messageOf<StateError>([&] { reader.getMoment(Scene()); }),
            "saved state: found an exposure of 2 models, bodies or lights, allowed 0 as in this scene");
}

TEST(StateRefusals, LightsAreAsManyAsAScenesMayBe) {
  const std::string bytes = record([](StateWriter& out) { out.put<std::uint64_t>(1000000); });
  StateReader reader(bytes);
  EXPECT_HAS(messageOf<StateError>([&] { reader.getLights(); }),
             "saved state: found 1000000 lights, allowed up to " + std::to_string(Lighting::kMostLights));
}

TEST(StateRefusals, AMotionIsThatOfAModel) {
  const MotionRun run{ModelMotion::fromYaml(YAML::Load("{type: constant_velocity}"), "motion"), Pose(), 0};
  const std::string bytes = record([&](StateWriter& out) { out.putMotions({{"moon", run}}); });
  StateReader reader(bytes);
  EXPECT_EQ(messageOf<StateError>([&] { reader.getMotions(ModelSet()); }),
            "saved state: found a motion of 'moon', which is not a model");
}

TEST(StateRefusals, AStateOfAnotherVersionIsToldApart) {
  const std::string bytes = record([](StateWriter& out) { out.put<std::uint64_t>(7); });
  Simulation simulation = fixture::panLift();
  EXPECT_EQ(messageOf<StateError>([&] { simulation.restoreState(bytes); }),
            "saved state: found one of another version, allowed one of this");
}

TEST(StateRefusals, AStateHasTheCamerasOfItsSimulation) {
  const Simulation blind = fixture::panLift("cameras: []");
  Simulation simulation = fixture::panLift();
  EXPECT_EQ(messageOf<StateError>([&] { simulation.restoreState(blind.saveState()); }),
            "saved state: found 0 cameras, allowed 1 as in this simulation");
}

TEST(StateRefusals, AStateWithCommandsOnTheirWayIsNoneOfASimulationWithoutDelay) {
  Simulation delayed = fixture::panLift("command_delay_s: 0.01");
  delayed.setCommand(JointCommand{{{"pan", 0.1}}, {}, {}});
  Simulation simulation = fixture::panLift();
  EXPECT_EQ(messageOf<StateError>([&] { simulation.restoreState(delayed.saveState()); }),
            "saved state: found bytes after its end, allowed a state of this simulation");
}

/** The state of a simulation whose one command is due then. */
std::string dueAt(Simulation& simulation, std::int64_t due_ns) {
  std::string state = simulation.saveState();
  const std::int64_t due = simulation.commands().nextDueNs();
  state.resize(state.size() - sizeof(std::uint64_t));
  const std::size_t place = state.rfind(std::string(reinterpret_cast<const char*>(&due), sizeof(due)));
  state.replace(place, sizeof(due_ns), reinterpret_cast<const char*>(&due_ns), sizeof(due_ns));
  return record([&](StateWriter& out) {
    for (const char byte : state) out.put(byte);
  });
}

TEST(StateRefusals, ACommandIsDueWithinThirtyYears) {
  Simulation simulation = fixture::panLift("command_delay_s: 0.0123");
  simulation.setCommand(JointCommand{{{"pan", 0.1}}, {}, {}});
  for (const std::int64_t due_ns : {std::int64_t{-1}, std::int64_t{1000000000000000001}}) {
    EXPECT_EQ(messageOf<StateError>([&] { simulation.restoreState(dueAt(simulation, due_ns)); }),
              "saved state: found a command that is due at " + std::to_string(due_ns) +
                  " ns, allowed 0 to 1000000000000000000");
  }
  EXPECT_NO_THROW(simulation.restoreState(dueAt(simulation, 20000000)));
  EXPECT_EQ(simulation.commands().nextDueNs(), 20000000);
}

}  // namespace
}  // namespace aras_visual_servo_sim
