#pragma once

#include <aras_visual_servo_msgs/DeleteModel.h>
#include <aras_visual_servo_msgs/GetModelState.h>
#include <aras_visual_servo_msgs/SetModelMotion.h>
#include <aras_visual_servo_msgs/SetModelState.h>
#include <aras_visual_servo_msgs/SpawnModel.h>
#include <ros/node_handle.h>

#include <string>
#include <vector>

#include "aras_visual_servo_sim/simulation/simulation.hpp"
#include "convert/wire_time.hpp"
#include "publish/scene_markers.hpp"

namespace aras_visual_servo_sim {

/** Services that add, remove and move models. A refused call is answered with the reason. */
class ModelServices {
 public:
  ModelServices(ros::NodeHandle& node, Simulation& simulation, SceneMarkers& markers, const WireTime& time);

 private:
  using SpawnModel = aras_visual_servo_msgs::SpawnModel;
  using DeleteModel = aras_visual_servo_msgs::DeleteModel;
  using SetModelState = aras_visual_servo_msgs::SetModelState;
  using GetModelState = aras_visual_servo_msgs::GetModelState;
  using SetModelMotion = aras_visual_servo_msgs::SetModelMotion;

  bool onSpawn(SpawnModel::Request& request, SpawnModel::Response& response);
  bool onDelete(DeleteModel::Request& request, DeleteModel::Response& response);
  bool onSetState(SetModelState::Request& request, SetModelState::Response& response);
  bool onGetState(GetModelState::Request& request, GetModelState::Response& response);
  bool onSetMotion(SetModelMotion::Request& request, SetModelMotion::Response& response);
  Pose frame(const std::string& name) const;
  template <typename Response, typename Action>
  bool answer(Response& response, const Action& action);

  Simulation& simulation_;
  SceneMarkers& markers_;
  const WireTime& time_;
  std::vector<ros::ServiceServer> services_;
};

}  // namespace aras_visual_servo_sim
