#include "model_services.hpp"

#include <aras_visual_servo_common/files.hpp>
#include <aras_visual_servo_common/yaml_value.hpp>
#include <cmath>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "aras_visual_servo_sim/scene/scene_config.hpp"
#include "convert/conversions.hpp"

namespace aras_visual_servo_sim {
namespace {

using aras_visual_servo_common::exactNumber;

YAML::Node constantVelocity(const geometry_msgs::Twist& twist) {
  YAML::Node motion;
  motion["type"] = "constant_velocity";
  for (const double value : {twist.linear.x, twist.linear.y, twist.linear.z}) {
    motion["linear_m_per_s"].push_back(exactNumber(value));
  }
  for (const double value : {twist.angular.x, twist.angular.y, twist.angular.z}) {
    motion["angular_rad_per_s"].push_back(exactNumber(value));
  }
  return motion;
}

bool isZero(const geometry_msgs::Twist& twist) {
  return twist.linear.x == 0.0 && twist.linear.y == 0.0 && twist.linear.z == 0.0 && twist.angular.x == 0.0 &&
         twist.angular.y == 0.0 && twist.angular.z == 0.0;
}

YAML::Node parsed(const std::string& yaml) {
  try {
    return aras_visual_servo_common::parseYaml(yaml, aras_visual_servo_common::kMostSentYaml);
  } catch (const ArasError& error) {
    throw ParameterError(std::string("motion: ") + error.what());
  }
}

}  // namespace

ModelServices::ModelServices(ros::NodeHandle& node, Simulation& simulation, SceneMarkers& markers, const WireTime& time)
    : simulation_(simulation), markers_(markers), time_(time) {
  services_ = {node.advertiseService("sim/spawn_model", &ModelServices::onSpawn, this),
               node.advertiseService("sim/delete_model", &ModelServices::onDelete, this),
               node.advertiseService("sim/set_model_pose", &ModelServices::onSetState, this),
               node.advertiseService("sim/get_model_state", &ModelServices::onGetState, this),
               node.advertiseService("sim/set_model_motion", &ModelServices::onSetMotion, this)};
}

template <typename Response, typename Action>
bool ModelServices::answer(Response& response, const Action& action) {
  try {
    action();
    response.success = true;
    markers_.publish();
  } catch (const ArasError& error) {
    response.success = false;
    response.status_message = error.what();
  }
  return true;
}

/** Pose of a model or link in the world; empty or "world": the world itself. @throws UnknownNameError */
Pose ModelServices::frame(const std::string& name) const {
  if (name.empty() || name == kWorldFrame) return Pose();
  for (const Link& link : simulation_.model().links) {
    if (link.name == name) return simulation_.body().linkPose(name);
  }
  return simulation_.models().pose(name);
}

bool ModelServices::onSpawn(SpawnModel::Request& request, SpawnModel::Response& response) {
  return answer(response, [&] {
    simulation_.spawnModel(modelEntry(request.model_name, request.model_xml),
                           frame(request.reference_frame) * fromMessage(request.initial_pose, Unset::kIdentity));
  });
}

bool ModelServices::onDelete(DeleteModel::Request& request, DeleteModel::Response& response) {
  return answer(response, [&] { simulation_.deleteModel(request.model_name); });
}

bool ModelServices::onSetState(SetModelState::Request& request, SetModelState::Response& response) {
  return answer(response, [&] {
    const Pose X_WM = frame(request.reference_frame) * fromMessage(request.pose, Unset::kRefused);
    std::optional<ModelMotion> motion;
    if (!isZero(request.twist)) motion = ModelMotion::fromYaml(constantVelocity(request.twist), "twist");
    simulation_.setModelPose(request.model_name, X_WM);
    simulation_.setModelMotion(request.model_name, motion);
  });
}

bool ModelServices::onGetState(GetModelState::Request& request, GetModelState::Response& response) {
  return answer(response, [&] {
    response.header.stamp = time_.now();
    response.header.frame_id = request.relative_entity_name.empty() ? kWorldFrame : request.relative_entity_name;
    response.pose =
        toMessage(frame(request.relative_entity_name).inverse() * simulation_.models().pose(request.model_name));
    response.twist = toMessage(simulation_.modelTwist(request.model_name));
  });
}

bool ModelServices::onSetMotion(SetModelMotion::Request& request, SetModelMotion::Response& response) {
  return answer(response, [&] {
    std::optional<ModelMotion> motion;
    if (!request.motion.empty()) motion = ModelMotion::fromYaml(parsed(request.motion), "motion");
    simulation_.setModelMotion(request.model_name, motion);
  });
}

}  // namespace aras_visual_servo_sim
