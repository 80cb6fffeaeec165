#pragma once

#include <yaml-cpp/yaml.h>

#include <string>
#include <vector>

#include "aras_visual_servo_sim/robot/urdf_loader.hpp"
#include "aras_visual_servo_sim/simulation/simulation.hpp"

namespace aras_visual_servo_sim::fixture {

inline std::string file(const std::string& name) { return std::string(ARAS_SIM_TEST_DIR) + "/ros/robot/" + name; }

/** Robot of test/ros/robot/pan_lift.urdf: joints lift, pan; camera `camera` at 30 Hz, physics at 1 ms. */
inline Simulation panLift(const std::string& extra_sim_yaml = "{}") {
  YAML::Node sim = YAML::LoadFile(file("sim.yaml"))["sim"];
  for (const auto& entry : YAML::Load(extra_sim_yaml)) sim[entry.first.as<std::string>()] = entry.second;
  return Simulation(loadRobotModelFile(file("pan_lift.urdf")), SimulationConfig::fromYaml(sim),
                    YAML::LoadFile(file("controllers.yaml")));
}

/** Hash of the run after so many more images of `camera`, each of them drawn. */
inline std::string hashOf(Simulation& simulation, int frames) {
  for (int k = 0; k < frames; ++k) {
    simulation.stepToImage("camera");
    simulation.render(0);
  }
  return simulation.runHash();
}

}  // namespace aras_visual_servo_sim::fixture
