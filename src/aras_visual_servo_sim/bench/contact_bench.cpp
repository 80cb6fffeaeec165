// Time of one step with things that touch, one thread, beside an arm that does not move. Time is what to read.
// Run: contact_bench [--benchmark_filter=...], or contact_bench --heaps [SEED]: the worst step of 200 heaps of solids
// inside each other, drawn from seeds SEED (default 0) on; milliseconds of CPU time as the last word.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <memory>
#include <string>

#include "aras_visual_servo_sim/physics/multibody_world.hpp"
#include "aras_visual_servo_sim/robot/urdf_loader.hpp"
#include "tools/heap.hpp"

namespace {

using namespace aras_visual_servo_sim;

constexpr double kEdge = 0.1;  // of the boxes [m]

/** An arm of one joint, out of the way. */
RobotModel slider() { return loadRobotModelFile(ARAS_SIM_TEST_DIR "/urdf/slider.urdf"); }

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

double cpuMs() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e3 * double(now.tv_sec) + 1e-6 * double(now.tv_nsec);
}

/** The heaps that the test ContactBound.TwoHundredHeapsStayFinite has, step by step. */
void worstOfHeaps(unsigned first_seed) {
  constexpr unsigned kHeaps = 200, kTries = 3;  // the least time of three: what others on the machine took is left out
  constexpr int kSteps = 5;
  const RobotModel model = slider();
  double worst_ms = 0.0;
  unsigned worst_seed = 0;
  int worst_step = 0;
  std::size_t worst_points = 0;
  for (unsigned seed = first_seed; seed < first_seed + kHeaps; ++seed) {
    double least_ms[kSteps];
    std::size_t points[kSteps];
    for (unsigned attempt = 0; attempt < kTries; ++attempt) {
      MultibodyWorld world(model, heap(seed, 2 + static_cast<int>(seed % 6)));
      for (int step = 0; step < kSteps; ++step) {
        const double start_ms = cpuMs();
        world.step(1);
        const double taken_ms = cpuMs() - start_ms;
        least_ms[step] = attempt == 0 ? taken_ms : std::min(least_ms[step], taken_ms);
        points[step] = world.contacts().size();
      }
    }
    for (int step = 0; step < kSteps; ++step) {
      if (least_ms[step] <= worst_ms) continue;
      worst_ms = least_ms[step];
      worst_seed = seed;
      worst_step = step;
      worst_points = points[step];
    }
  }
  std::printf("worst step of %u heaps: seed %u, step %d, %zu points [ms]: %.2f\n", kHeaps, worst_seed, worst_step + 1,
              worst_points, worst_ms);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc >= 2 && std::string(argv[1]) == "--heaps") {
    worstOfHeaps(argc > 2 ? static_cast<unsigned>(std::strtoul(argv[2], nullptr, 10)) : 0U);
    return 0;
  }
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
