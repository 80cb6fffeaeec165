#pragma once

#include <ros/node_handle.h>

#include <string>
#include <vector>

#include "aras_visual_servo_sim/simulation/simulation.hpp"
#include "convert/wire_time.hpp"
#include "publish/scene_markers.hpp"

namespace aras_visual_servo_sim {

/** Services that add, remove, move and list models and lights. A refused call is answered with the reason. */
class ModelServices {
 public:
  ModelServices(ros::NodeHandle& node, Simulation& simulation, SceneMarkers& markers, const WireTime& time);

 private:
  void serveModels(ros::NodeHandle& node);
  void serveLights(ros::NodeHandle& node);
  Pose frame(const std::string& name) const;
  template <typename Service, typename Action>
  void serve(ros::NodeHandle& node, const std::string& name, const Action& action);

  Simulation& simulation_;
  SceneMarkers& markers_;
  const WireTime& time_;
  std::vector<ros::ServiceServer> services_;
};

}  // namespace aras_visual_servo_sim
