// What nodes tell a running simulation: commands to joints and controllers, gains, placements.
#include <fuzzer/FuzzedDataProvider.h>

#include <cmath>
#include <limits>

#include "aras_visual_servo_sim/physics/managed/trajectory_controller.hpp"
#include "small_simulation.hpp"
#include "target.hpp"

using namespace aras_visual_servo_sim;

namespace {

double number(FuzzedDataProvider& bytes) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  static const double kNumbers[] = {0.0,  -0.0,  1.0,   -1.0,   0.5,   2.0,       -2.0,       3.5,
                                    1e-9, 1e4,   -1e4,  1e9,    1e18,  1e300,     -1e300,     5e-324,
                                    1e-3, 1e-30, 100.0, -100.0, 1e308, kInfinity, -kInfinity, std::nan("")};
  if (bytes.ConsumeBool()) return bytes.PickValueInArray(kNumbers);
  double value = 0.0;
  const std::string raw = bytes.ConsumeBytesAsString(sizeof(value));
  std::memcpy(&value, raw.data(), raw.size());
  return value;
}

std::string joint(FuzzedDataProvider& bytes) {
  return bytes.PickValueInArray<std::string>({"slide", "turn", "nobody", ""});
}

Pose pose(FuzzedDataProvider& bytes) {
  Pose X;
  X.p = {number(bytes), number(bytes), number(bytes)};
  X.q = Eigen::Quaterniond(number(bytes), number(bytes), number(bytes), number(bytes));
  return X;
}

void command(Simulation& simulation, FuzzedDataProvider& bytes) {
  JointCommand told;
  for (auto* part : {&told.position, &told.velocity, &told.effort}) {
    for (int k = bytes.ConsumeIntegralInRange(0, 2); k > 0; --k) (*part)[joint(bytes)] = number(bytes);
  }
  if (bytes.ConsumeBool()) return simulation.setCommand(told);
  simulation.setCommand(told, bytes.ConsumeIntegral<std::int64_t>());
}

void follow(Simulation& simulation, FuzzedDataProvider& bytes) {
  auto& controller = dynamic_cast<TrajectoryController&>(simulation.body().runningController("follow"));
  Trajectory way;
  for (int k = bytes.ConsumeIntegralInRange(0, 3); k > 0; --k) way.joints.push_back(joint(bytes));
  if (bytes.ConsumeBool()) way.start_s = number(bytes);
  const auto numbers = [&] {
    std::vector<double> values(bytes.ConsumeIntegralInRange<std::size_t>(0, 2));
    for (double& value : values) value = number(bytes);
    return values;
  };
  for (int k = bytes.ConsumeIntegralInRange(0, 3); k > 0; --k) {
    way.points.push_back({numbers(), numbers(), numbers(), number(bytes)});
  }
  const auto joints = simulation.body().jointsOf(controller);
  if (bytes.ConsumeBool()) {
    controller.follow(way, simulation.timeS(), joints);
    return;
  }
  GoalTolerances tolerances;
  tolerances.path[joint(bytes)] = {number(bytes), number(bytes), number(bytes)};
  tolerances.goal[joint(bytes)] = {number(bytes), number(bytes), number(bytes)};
  tolerances.goal_time_s = number(bytes);
  controller.pursue(way, tolerances, simulation.timeS(), joints);
}

void tell(Simulation& simulation, FuzzedDataProvider& bytes) {
  switch (bytes.ConsumeIntegralInRange(0, 8)) {
    case 0:
      return command(simulation, bytes);
    case 1:
      return simulation.setControllerCommand(joint(bytes), number(bytes));
    case 2:
      return simulation.body().setGains(joint(bytes), {number(bytes), number(bytes), number(bytes), number(bytes),
                                                       number(bytes), bytes.ConsumeBool()});
    case 3:
      return simulation.setJointPositions({{joint(bytes), number(bytes)}});
    case 4:
      return simulation.setModelPose(bytes.ConsumeBool() ? "crate" : "target", pose(bytes));
    case 5: {
      const bool trajectory = bytes.ConsumeBool();
      const std::vector<std::string> some{"follow"}, others{"slide", "turn"};
      return simulation.body().switchControllers(trajectory ? some : others, trajectory ? others : some,
                                                 bytes.ConsumeBool());
    }
    case 6:
      return follow(simulation, bytes);
    case 7: {
      Twist twist;
      for (double& each : twist) each = number(bytes);
      return simulation.setTwist(twist, "tip");
    }
    default:
      return simulation.setModelMotion("target", std::nullopt);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const std::unique_ptr<Simulation> kSimulation = fuzz::smallSimulation();
  static const std::string kStart = [] {
    kSimulation->body().loadController("follow",
                                       YAML::Load("{type: effort_controllers/JointTrajectoryController, joints: "
                                                  "[slide, turn], gains: {slide: {p: 100, d: 20}, turn: {p: 9}}}"));
    kSimulation->step(3);
    return kSimulation->saveState();
  }();
  Simulation& simulation = *kSimulation;
  FuzzedDataProvider bytes(data, size);
  for (int told = 0; told < 16 && bytes.remaining_bytes() > 0; ++told) {
    fuzz::allow([&] { tell(simulation, bytes); });
    const auto periods = bytes.ConsumeIntegralInRange(0, 3);
    if (!fuzz::allow([&] { simulation.step(periods); })) break;
    if (!fuzz::finite(simulation)) __builtin_trap();
  }
  simulation.restoreState(kStart);
  return 0;
}
