#pragma once

#include <yaml-cpp/yaml.h>

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "aras_visual_servo_sim/camera/camera_config.hpp"
#include "aras_visual_servo_sim/physics/world_config.hpp"
#include "aras_visual_servo_sim/scene/scene_config.hpp"

namespace aras_visual_servo_sim {

/** The `sim:` section of a scenario. schema/sim.yaml says what each key means. */
struct SimulationConfig {
  WorldConfig world;
  double command_delay_s = 0.0;                     ///< how long commands are on their way
  std::uint64_t seed = 0;                           ///< of the image noise
  std::map<std::string, double> initial_positions;  ///< by joint name [m or rad]
  std::vector<CameraConfig> cameras;
  std::string tag_renderer = "opengl";  ///< of cameras that are taken from the URDF's tags
  bool gazebo_cameras = false;          ///< `compatibility`: "gazebo"; cameras of the URDF are as Gazebo has them
  SceneConfig scene;

  /** @param node  the section; null gives the defaults
   *  @throws ParameterError listing every fault (unknown key, wrong type, out of range), all at once */
  static SimulationConfig fromYaml(const YAML::Node& node);
};

}  // namespace aras_visual_servo_sim
