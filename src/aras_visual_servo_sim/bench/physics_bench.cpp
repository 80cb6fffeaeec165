// Steps of the articulated body per second, one thread. items_per_second is what to read.
#include <benchmark/benchmark.h>

#include <cmath>
#include <memory>

#include "aras_visual_servo_sim/physics/multibody_world.hpp"
#include "aras_visual_servo_sim/robot/urdf_loader.hpp"

namespace {

using namespace aras_visual_servo_sim;

MultibodyWorld& armWorld(Drive drive) {
  static std::unique_ptr<MultibodyWorld> world;
  WorldConfig config;
  config.drive = drive;
  const auto add = [&](const char* joint, double p, double i, double d) {
    ControllerConfig controller;
    controller.name = controller.joint = joint;
    controller.gains = PidGains{p, i, d, -1000.0, 1000.0, false};
    config.controllers.push_back(controller);
  };
  add("gantry", 15000, 5, 400);
  add("J1", 3000, 40, 40);
  add("J2", 7000, 1000, 165);
  add("J3", 4000, 200, 0);
  add("J5", 3500, 150, 0);
  add("J6", 70, 2, 0);
  world = std::make_unique<MultibodyWorld>(loadRobotModelFile(ARAS_SIM_TEST_DIR "/urdf/six_joint_arm.urdf"), config);
  return *world;
}

/** The arm with six PIDs, friction, damping and limits, its set-points moving at 30 Hz. */
void moving(benchmark::State& state, Drive drive) {
  MultibodyWorld& world = armWorld(drive);
  JointCommand command;
  long k = 0;
  for (auto _ : state) {
    if (k % 33 == 0) {
      command.velocity = {{"gantry", 0.1 * std::sin(1e-3 * k)}, {"J2", 0.2 * std::cos(1e-3 * k)}, {"J6", 0.3}};
      world.setCommand(command);
    }
    world.step();
    ++k;
  }
  state.SetItemsProcessed(state.iterations());
}

void resting(benchmark::State& state) {
  MultibodyWorld& world = armWorld(Drive::kImplicit);
  world.step(2000);
  for (auto _ : state) world.step();
  state.SetItemsProcessed(state.iterations());
}

void cameraPose(benchmark::State& state) {
  MultibodyWorld& world = armWorld(Drive::kImplicit);
  const int camera = world.model().linkIndex("camera");
  for (auto _ : state) benchmark::DoNotOptimize(world.linkPose(camera));
}

BENCHMARK_CAPTURE(moving, implicit, Drive::kImplicit);
BENCHMARK_CAPTURE(moving, explicit, Drive::kExplicit);
BENCHMARK(resting);
BENCHMARK(cameraPose);

}  // namespace

BENCHMARK_MAIN();
