// Camera latency: when a frame can be taken, what it shows then, and what of it a saved state holds.
#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "tools/pan_lift.hpp"

namespace aras_visual_servo_sim::latency_test {
namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr std::int64_t kMillisecond = 1000000;
const std::vector<std::int64_t> kFrameTicks = {0, 34, 67, 100, 134};  // at 30 Hz and 1 ms

/** A target in motion below the panning robot; `camera` is added to the camera's keys, `more` are further cameras. */
std::unique_ptr<Simulation> moving(const std::string& camera, const std::string& more = "") {
  std::unique_ptr<Simulation> simulation(new Simulation(fixture::panLift(
      "{gravity_m_s2: [0, 0, 0], cameras: [{name: camera, frame: eye_optical_frame, width: 64, height: 48, "
      "horizontal_fov_rad: 1.0" +
      camera + "}" + more +
      "], scene: {models: [{name: target, color_rgb: [20, 20, 20], "
      "outlines_m: [[[-0.1, -0.05], [0.1, -0.05], [0.1, 0.05], [-0.1, 0.05]]], "
      "motion: {type: constant_velocity, linear_m_per_s: [0.5, 0.2, 0.0]}}], "
      "solids: [{name: crate, box_m: [0.04, 0.04, 0.04], position_m: [0.05, -0.05, 0.0]}]}}")));
  simulation->setControllerCommand("pan_controller", 1.0);
  return simulation;
}

struct Taken {
  std::int64_t stamp_ns, now_ns;
  Bytes image;
  Eigen::VectorXd q;
  Eigen::Matrix4d X_WC, X_WT = Eigen::Matrix4d::Zero();
};

Taken next(Simulation& simulation, const std::string& camera = "camera") {
  Taken taken;
  taken.stamp_ns = simulation.stepToImage(camera);
  taken.now_ns = simulation.timeNs();
  const int index = simulation.cameras().index(camera);
  taken.image = simulation.render(index).data;
  const ExposedFrame* late = simulation.cameras()[index].takenFrame();
  taken.q = late ? late->q : simulation.body().jointPositions();
  taken.X_WC = late ? late->present.X_WC.matrix() : simulation.cameraPose(index).matrix();
  for (const auto& [name, X_WM] : simulation.frameState(index).models) {
    if (name == "target") taken.X_WT = X_WM.matrix();
  }
  return taken;
}

std::string hashOf(Simulation& simulation, int frames) {
  for (int k = 0; k < frames; ++k) next(simulation);
  return simulation.runHash();
}

TEST(Latency, ImageIsThatOfItsStampAndComesLater) {
  // Within a period, whole ticks and not (rounded up), a period, and several of them; blur and noise on top.
  for (const auto& [latency, ticks] : std::vector<std::pair<std::string, std::int64_t>>{
           {"0.02", 20}, {"0.0195", 20}, {"0.033", 33}, {"0.1", 100}, {"0.25", 250}}) {
    for (const std::string extra : {"", ", exposure_s: 0.02, exposure_samples: 4, noise_stddev: 2.0"}) {
      const auto prompt = moving(extra), late = moving(extra + ", latency_s: " + latency);
      for (const std::int64_t tick : kFrameTicks) {
        const Taken expected = next(*prompt), found = next(*late);
        EXPECT_EQ(found.stamp_ns, tick * kMillisecond);
        EXPECT_EQ(found.now_ns, (tick + ticks) * kMillisecond) << latency;
        EXPECT_EQ(found.image, expected.image) << latency << extra << " tick " << tick;
        EXPECT_EQ(found.q, expected.q);
        EXPECT_EQ(found.X_WC, expected.X_WC);
        EXPECT_EQ(found.X_WT, expected.X_WT);
      }
    }
  }
}

TEST(Latency, DepthAndIdsAreThoseOfTheImage) {
  const auto prompt = moving(""), late = moving(", latency_s: 0.05");
  next(*prompt);
  next(*late);
  next(*prompt);
  next(*late);
  EXPECT_EQ(late->renderGeometry(0).ids, prompt->renderGeometry(0).ids);
  late->step(1);  // nothing was taken at this tick: the present
  prompt->step(late->ticks() - prompt->ticks());
  EXPECT_EQ(late->renderGeometry(0).ids, prompt->renderGeometry(0).ids);
  EXPECT_EQ(late->render(0).data, prompt->render(0).data);
}

TEST(Latency, FramesInFlightShowWhatWasThereWhenTheyWereExposed) {
  const Pose there{{0.05, 0.0, 0.0}, Eigen::Quaterniond::Identity()};
  const YAML::Node box = YAML::Load("{name: box, box_m: [0.05, 0.05, 0.05], position_m: [0.1, 0, 0.1]}");
  const YAML::Node flat = YAML::Load(
      "{name: flat, color_rgb: [200, 0, 0], outlines_m: [[[-0.1, -0.1], [0.1, -0.1], [0, 0.1]]], "
      "position_m: [0, 0, 0.05]}");
  const std::vector<std::function<void(Simulation&)>> changes = {
      [&](Simulation& simulation) { simulation.setModelPose("target", there); },
      [&](Simulation& simulation) {
        simulation.setJointPositions({{"pan", -0.3}});
      },
      [&](Simulation& simulation) {
        simulation.spawnModel(box);
        simulation.spawnModel(flat);
        simulation.deleteModel("box");
      },
      [&](Simulation& simulation) { simulation.deleteModel("target"); },
      [&](Simulation& simulation) { simulation.deleteModel("crate"); },
      [&](Simulation& simulation) { simulation.resetWorld(); }};
  for (std::size_t k = 0; k < changes.size(); ++k) {
    const auto prompt = moving(", exposure_s: 0.01"), late = moving(", exposure_s: 0.01, latency_s: 0.08");
    std::vector<Bytes> expected;
    for (int frame = 0; frame < 3; ++frame) expected.push_back(next(*prompt).image);
    late->step(70);  // frames 0, 1, 2 are in flight
    changes[k](*late);
    const std::string state = late->saveState();
    for (int run = 0; run < 2; ++run) {
      for (int frame = 0; frame < 3; ++frame) {
        EXPECT_EQ(next(*late).image, expected[frame]) << "change " << k << " frame " << frame << " run " << run;
      }
      late->restoreState(state);
    }
    const auto other = moving(", exposure_s: 0.01, latency_s: 0.08");
    other->restoreState(state);
    EXPECT_EQ(hashOf(*other, 5), hashOf(*late, 5)) << "change " << k;
  }
}

TEST(Latency, SavedStateHoldsTheFramesInFlightAndTheOneJustTaken) {
  for (const std::int64_t tick : {0, 40, 67, 90, 100, 134}) {
    const std::string keys = ", latency_s: 0.1, exposure_s: 0.02, noise_stddev: 2.0, drop_probability: 0.3";
    const auto simulation = moving(keys), other = moving(keys);
    simulation->step(tick);
    if (simulation->cameras()[0].frameDue(simulation->ticks())) simulation->takeFrame(0);
    const std::string state = simulation->saveState();
    const Bytes image = simulation->render(0).data;
    const std::string hash = hashOf(*simulation, 4);
    const std::uint64_t dropped = simulation->cameras().droppedFrames();
    for (Simulation* each : {simulation.get(), other.get()}) {
      each->restoreState(state);
      EXPECT_EQ(each->render(0).data, image) << "tick " << tick;
      EXPECT_EQ(hashOf(*each, 4), hash) << "tick " << tick;
      EXPECT_EQ(each->cameras().droppedFrames(), dropped);
    }
    const auto prompt = moving("");
    EXPECT_THROW(prompt->restoreState(state), StateError);
    EXPECT_THROW(simulation->restoreState(prompt->saveState()), StateError);
  }
}

TEST(Latency, SameBytesHoweverItIsSteppedAndAfterAReset) {
  const auto once = moving(", latency_s: 0.07"), again = moving(", latency_s: 0.07");
  const std::string hash = hashOf(*once, 6);
  for (int k = 0; k < 6; ++k) {
    while (!again->cameras()[0].frameDue(again->ticks())) again->step(1);
    again->takeFrame(0);
    again->render(0);
  }
  EXPECT_EQ(again->runHash(), hash);
  once->step(50);
  once->reset();
  EXPECT_TRUE(once->cameras()[0].lateFrames().empty());
  once->setControllerCommand("pan_controller", 1.0);
  EXPECT_EQ(hashOf(*once, 6), hash);
}

TEST(Latency, CamerasOfDifferentLatencyDeliverInTheOrderOfTime) {
  const std::string far =
      ", {name: far, frame: eye_optical_frame, width: 32, height: 24, horizontal_fov_rad: 1.0, rate_hz: 50.0, "
      "latency_s: 0.075}";
  const auto simulation = moving(", latency_s: 0.01", far);
  std::vector<std::pair<std::string, std::int64_t>> found;
  while (found.size() < 9) {
    const bool near_first = simulation->cameras()[0].nextFrameTick() <= simulation->cameras()[1].nextFrameTick();
    const std::string camera = near_first ? "camera" : "far";
    found.emplace_back(camera, next(*simulation, camera).stamp_ns / kMillisecond);
  }
  // Deliveries at 10, 44, 75, 77, 95, 110, 115, 135, 144.
  const std::vector<std::pair<std::string, std::int64_t>> expected = {{"camera", 0},  {"camera", 34}, {"far", 0},
                                                                      {"camera", 67}, {"far", 20},    {"camera", 100},
                                                                      {"far", 40},    {"far", 60},    {"camera", 134}};
  EXPECT_EQ(found, expected);
}

TEST(Latency, AFrameThatNobodyTakesIsLost) {
  const auto simulation = moving(", latency_s: 0.05");
  simulation->step(60);
  EXPECT_EQ(simulation->cameras()[0].nextFrameTick(), 84);  // frame 0 was delivered at 50, frame 1 comes at 34 + 50
  EXPECT_THROW(simulation->takeFrame(0), ParameterError);
  EXPECT_EQ(next(*simulation).stamp_ns, 34 * kMillisecond);
  EXPECT_TRUE(simulation->cameras()[0].frameTaken(simulation->ticks()));
  simulation->step(1);
  EXPECT_FALSE(simulation->cameras()[0].frameTaken(simulation->ticks()));
  EXPECT_EQ(simulation->cameras()[0].takenFrame(), nullptr);
}

TEST(Latency, TriggeredFrameComesLateToo) {
  const auto simulation = moving(", latency_s: 0.1, triggered: true");
  EXPECT_THROW(simulation->stepToImage("camera"), ParameterError);
  simulation->step(20);
  simulation->trigger(0);
  simulation->step(30);
  simulation->trigger(0);  // the frame of 34 ms is in flight: this is the next one
  EXPECT_EQ(next(*simulation).stamp_ns, 34 * kMillisecond);
  EXPECT_EQ(simulation->timeNs(), 134 * kMillisecond);
  EXPECT_EQ(next(*simulation).stamp_ns, 67 * kMillisecond);
  EXPECT_EQ(simulation->cameras()[0].nextFrameTick(), Simulation::kNever);
}

TEST(Latency, AgeOfACommandCountsFromTheDelivery) {
  const auto prompt = moving(""), late = moving(", latency_s: 0.2");  // command_timeout_s is 0.1
  JointCommand command;
  command.velocity["pan"] = 0.1;
  for (Simulation* each : {prompt.get(), late.get()}) each->step(250);
  EXPECT_THROW(prompt->setCommand(command, 50 * kMillisecond), ParameterError);
  EXPECT_NO_THROW(late->setCommand(command, 50 * kMillisecond));
  late->step(60);
  EXPECT_THROW(late->setCommand(command, 5 * kMillisecond), ParameterError);
}

TEST(Latency, OutOfRangeIsRefused) {
  for (const char* value : {"-0.001", "10.1", ".nan", ".inf"}) {
    try {
      moving(std::string(", latency_s: ") + value);
      ADD_FAILURE() << value << " was accepted";
    } catch (const ParameterError& error) {
      EXPECT_NE(std::string(error.what()).find("latency_s"), std::string::npos) << error.what();
    }
  }
}

}  // namespace
}  // namespace aras_visual_servo_sim::latency_test
