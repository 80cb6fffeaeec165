#pragma once

#include <aras_visual_servo_msgs/DeleteLight.h>
#include <aras_visual_servo_msgs/GetLights.h>
#include <aras_visual_servo_msgs/SetLight.h>
#include <ros/node_handle.h>

#include <vector>

#include "aras_visual_servo_sim/simulation/simulation.hpp"

namespace aras_visual_servo_sim {

/** Services that add, change, remove and list lights. A refused call is answered with the reason. */
class LightServices {
 public:
  LightServices(ros::NodeHandle& node, Simulation& simulation);

 private:
  using SetLight = aras_visual_servo_msgs::SetLight;
  using DeleteLight = aras_visual_servo_msgs::DeleteLight;
  using GetLights = aras_visual_servo_msgs::GetLights;

  bool onSet(SetLight::Request& request, SetLight::Response& response);
  bool onDelete(DeleteLight::Request& request, DeleteLight::Response& response);
  bool onGet(GetLights::Request& request, GetLights::Response& response);

  Simulation& simulation_;
  std::vector<ros::ServiceServer> services_;
};

}  // namespace aras_visual_servo_sim
