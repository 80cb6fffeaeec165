#pragma once

#include <string>
#include <vector>

#include "aras_visual_servo_sim/simulation/simulation.hpp"

namespace aras_visual_servo_sim {

/** Names of a camera's topics; relative ones are in the node's namespace. */
struct CameraTopics {
  std::string image, info, depth, segmentation, trigger;
};

/** Topics of every camera of the simulation, in its order: <name>/image_raw and so on, or what the plugin tag of the
 *  URDF's camera of that name says.
 *  @param gazebo_names  cameras with a plugin tag get the names that GazeboRosCameraUtils (gazebo_plugins) gives them:
 *         from the root, under the tag's <robotNamespace> if there is one (an empty one is the robot's name) */
std::vector<CameraTopics> cameraTopics(const Simulation& simulation, bool gazebo_names);

}  // namespace aras_visual_servo_sim
