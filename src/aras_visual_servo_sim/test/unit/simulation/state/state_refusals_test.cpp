// What is said of a saved state that is whole, and yet none of this simulation.
#include <string>

#include "simulation/state/state_archive.hpp"
#include "tools/pan_lift.hpp"
#include "tools/physics_tools.hpp"

namespace aras_visual_servo_sim::state_refusals_test {
namespace {

const auto kNoModels = [](const std::vector<SavedModel>&) { return ModelSet(); };

/** Writes a record by a function and reads it by another one. @return what the reader says */
template <typename Write, typename Read>
std::string refusal(const Write& write, const Read& read) {
  StateArchive out;
  write(out);
  StateArchive in(out.take());
  return messageOf<StateError>([&] { read(in); });
}

TEST(StateRefusals, DamagedBytesAreCounted) {
  for (const char* record : {"abc", "abcdefgh"}) {
    EXPECT_EQ(messageOf<StateError>([&] { StateArchive archive(record); }),
              "saved state: found " + std::to_string(std::string(record).size()) +
                  " bytes that are damaged, cut short or none of save_state's");
  }
}

TEST(StateRefusals, ARecordThatEndsEarlyIsRefused) {
  std::uint64_t size = 1000;
  std::string text;
  EXPECT_EQ(refusal([&](StateArchive& out) { out(size); }, [&](StateArchive& in) { in(text); }),
            "saved state: found 8 bytes, allowed more: it ends early");
}

TEST(StateRefusals, AVectorHasASizeOfItsOwn) {
  Eigen::VectorXd three = Eigen::VectorXd::Zero(3), two = Eigen::VectorXd::Zero(2);
  EXPECT_EQ(refusal([&](StateArchive& out) { out(three); }, [&](StateArchive& in) { in(two); }),
            "saved state: found a vector of 3 numbers, allowed 2 for this robot");
}

TEST(StateRefusals, APoseIsFinite) {
  std::array<double, 7> numbers{0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0};
  for (const std::size_t place : {1, 5}) {
    std::array<double, 7> forged = numbers;
    forged[place] = place == 1 ? std::nan("") : std::numeric_limits<double>::infinity();
    Pose pose;
    EXPECT_EQ(refusal([&](StateArchive& out) { out(forged); }, [&](StateArchive& in) { in(pose); }),
              "saved state: a pose is not finite");
  }
}

TEST(StateRefusals, AnExposureIsOfAsManyModelsAsThereAre) {
  Moment two_bodies, moment;
  two_bodies.bodies.resize(2);
  EXPECT_EQ(refusal([&](StateArchive& out) { out.moment(two_bodies, Scene()); },
                    [&](StateArchive& in) { in.moment(moment, Scene()); }),
            "saved state: found an exposure of 2 models, bodies or lights, allowed 0 as in this scene");
}

TEST(StateRefusals, LightsAreAsManyAsAScenesMayBe) {
  ModelSet bright, set;
  bright.scene.lighting.lights.resize(Lighting::kMostLights + 1);
  EXPECT_HAS(refusal([&](StateArchive& out) { out.models(bright, kNoModels); },
                     [&](StateArchive& in) { in.models(set, kNoModels); }),
             "lights, allowed up to " + std::to_string(Lighting::kMostLights));
}

TEST(StateRefusals, AMotionIsThatOfAModel) {
  const MotionRun run{ModelMotion::fromYaml(YAML::Load("{type: constant_velocity}"), "motion"), Pose(), 0};
  std::map<std::string, MotionRun> motions{{"moon", run}}, read;
  EXPECT_EQ(refusal([&](StateArchive& out) { out.motions(motions, ModelSet()); },
                    [&](StateArchive& in) { in.motions(read, ModelSet()); }),
            "saved state: found a motion of 'moon', which is not a model");
}

TEST(StateRefusals, AStateOfAnotherVersionIsToldApart) {
  StateArchive out;
  std::uint64_t version = 7;
  out(version);
  Simulation simulation = fixture::panLift();
  EXPECT_EQ(messageOf<StateError>([&] { simulation.restoreState(out.take()); }),
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
  StateArchive out;
  for (char byte : state) out(byte);
  return out.take();
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
}  // namespace aras_visual_servo_sim::state_refusals_test
