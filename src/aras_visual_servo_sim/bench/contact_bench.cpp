// Time of one step with things that touch, one thread, beside an arm that does not move. Time is what to read.
#include <benchmark/benchmark.h>

#include <memory>
#include <string>

#include "aras_visual_servo_sim/physics/multibody_world.hpp"
#include "aras_visual_servo_sim/robot/urdf_loader.hpp"

namespace {

using namespace aras_visual_servo_sim;

constexpr double kEdge = 0.1;  // of the boxes [m]

/** An arm of one joint, out of the way. */
RobotModel slider() {
  const std::string here = __FILE__;
  return loadRobotModelFile(here.substr(0, here.rfind('/')) + "/../test/urdf/slider.urdf");
}

Obstacle boxAt(const std::string& name, const Eigen::Vector3d& p) {
  Obstacle box;
  box.name = name;
  box.geometry.size_m.setConstant(kEdge);
  box.X_WO = Pose{p, Eigen::Quaterniond::Identity()};
  box.mass_kg = 0.5;
  return box;
}

/** Boxes on the ground plane: `piles` side by side, `high` of them on each other; gravity leans by `slope`. */
std::unique_ptr<MultibodyWorld> boxes(int piles, int high, double slope) {
  WorldConfig config;
  config.gravity_m_s2 = 9.81 * Eigen::Vector3d(slope, 0.0, -1.0).normalized();
  config.contacts.ground = GroundPlane{0.0, 0.5};
  for (int pile = 0; pile < piles; ++pile) {
    for (int level = 0; level < high; ++level) {
      const std::string name = "box" + std::to_string(pile) + std::to_string(level);
      config.contacts.obstacles.push_back(boxAt(name, {0.0, 1.0 + 0.2 * pile, (0.5 + level) * kEdge}));
      if (level > 0) config.contacts.pairs.emplace_back(name, "box" + std::to_string(pile) + std::to_string(level - 1));
    }
  }
  auto world = std::make_unique<MultibodyWorld>(slider(), config);
  world->step(200);
  return world;
}

void steps(benchmark::State& state, int piles, int high, double slope) {
  const auto world = boxes(piles, high, slope);
  for (auto _ : state) world->step();
  state.counters["points"] = static_cast<double>(world->contacts().size());
}

BENCHMARK_CAPTURE(steps, one_box_resting, 1, 1, 0.0);
BENCHMARK_CAPTURE(steps, two_boxes_resting, 2, 1, 0.0);
BENCHMARK_CAPTURE(steps, two_boxes_held_on_a_slope, 2, 1, 0.4);
BENCHMARK_CAPTURE(steps, two_boxes_sliding, 2, 1, 0.7);
BENCHMARK_CAPTURE(steps, stack_of_two, 1, 2, 0.0);
BENCHMARK_CAPTURE(steps, stack_of_three, 1, 3, 0.0);

}  // namespace

BENCHMARK_MAIN();
