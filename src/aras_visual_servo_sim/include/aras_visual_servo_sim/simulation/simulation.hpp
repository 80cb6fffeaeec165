#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "aras_visual_servo_sim/simulation/world.hpp"

namespace aras_visual_servo_sim {

/** A world that is its one robot. The robot has no name: its links and cameras are called as they are. */
class Simulation : public World, public Robot {
 public:
  /** @param controllers  ros_control's layout, see parseControllers
   *  @throws ParameterError, ModelError listing what is wrong */
  Simulation(RobotModel model, const SimulationConfig& config, const YAML::Node& controllers,
             const PackagePaths& packages = PackagePaths())
      : World(config, packages, Unbuilt()), Robot("", 0, std::move(model), config, periodNs(), packages) {
    build(std::shared_ptr<Robot>(std::shared_ptr<void>(), this), controllers);
  }

  /** Gives the cameras other settings while time goes on, also for the time after a reset: all but those that
   * camera_info tells, and the rate. Frames on their way come as the new latency says; those that it lets come no more
   * are lost.
   *  @throws ParameterError naming what would have to be as at the start; nothing changes then */
  void setCameras(const std::vector<CameraConfig>& cameras) { World::setCameras(cameras, *this); }
};

}  // namespace aras_visual_servo_sim
