#include "model_services.hpp"

#include <aras_visual_servo_msgs/DeleteLight.h>
#include <aras_visual_servo_msgs/DeleteModel.h>
#include <aras_visual_servo_msgs/GetLights.h>
#include <aras_visual_servo_msgs/GetModelState.h>
#include <aras_visual_servo_msgs/SetLight.h>
#include <aras_visual_servo_msgs/SetModelMotion.h>
#include <aras_visual_servo_msgs/SetModelState.h>
#include <aras_visual_servo_msgs/SpawnModel.h>

#include <aras_visual_servo_common/files.hpp>
#include <aras_visual_servo_common/yaml_value.hpp>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "aras_visual_servo_sim/scene/light_entry.hpp"
#include "aras_visual_servo_sim/scene/scene_config.hpp"
#include "convert/answer.hpp"
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
  serveModels(node);
  serveLights(node);
}

/** Offers a service: what the action throws is the reason of a refusal. */
template <typename Service, typename Action>
void ModelServices::serve(ros::NodeHandle& node, const std::string& name, const Action& action) {
  using Request = typename Service::Request;
  using Response = typename Service::Response;
  services_.push_back(
      node.advertiseService<Request, Response>(name, [this, action](Request& request, Response& response) {
        return answer(response, [&] {
          action(request, response);
          markers_.publish();
        });
      }));
}

/** Pose of a model or link in the world; empty or "world": the world itself. @throws UnknownNameError */
Pose ModelServices::frame(const std::string& name) const {
  if (name.empty() || name == kWorldFrame) return Pose();
  for (const Link& link : simulation_.model().links) {
    if (link.name == name) return simulation_.body().linkPose(name);
  }
  return simulation_.models().pose(name);
}

void ModelServices::serveModels(ros::NodeHandle& node) {
  serve<aras_visual_servo_msgs::SpawnModel>(node, "sim/spawn_model", [this](const auto& request, auto&) {
    simulation_.spawnModel(modelEntry(request.model_name, request.model_xml),
                           frame(request.reference_frame) * fromMessage(request.initial_pose, Unset::kIdentity));
  });
  serve<aras_visual_servo_msgs::DeleteModel>(
      node, "sim/delete_model", [this](const auto& request, auto&) { simulation_.deleteModel(request.model_name); });
  serve<aras_visual_servo_msgs::SetModelState>(node, "sim/set_model_pose", [this](const auto& request, auto&) {
    const Pose X_WM = frame(request.reference_frame) * fromMessage(request.pose, Unset::kRefused);
    std::optional<ModelMotion> motion;
    if (!isZero(request.twist)) motion = ModelMotion::fromYaml(constantVelocity(request.twist), "twist");
    simulation_.setModelPose(request.model_name, X_WM);
    simulation_.setModelMotion(request.model_name, motion);
  });
  serve<aras_visual_servo_msgs::GetModelState>(
      node, "sim/get_model_state", [this](const auto& request, auto& response) {
        const std::string& relative = request.relative_entity_name;
        response.header.stamp = time_.now();
        response.header.frame_id = relative.empty() ? kWorldFrame : relative;
        response.pose = toMessage(frame(relative).inverse() * simulation_.models().pose(request.model_name));
        response.twist = toMessage(simulation_.modelTwist(request.model_name));
      });
  serve<aras_visual_servo_msgs::SetModelMotion>(node, "sim/set_model_motion", [this](const auto& request, auto&) {
    std::optional<ModelMotion> motion;
    if (!request.motion.empty()) motion = ModelMotion::fromYaml(parsed(request.motion), "motion");
    simulation_.setModelMotion(request.model_name, motion);
  });
}

void ModelServices::serveLights(ros::NodeHandle& node) {
  serve<aras_visual_servo_msgs::SetLight>(node, "sim/set_light", [this](const auto& request, auto&) {
    simulation_.setLight(lightFromText(request.light));
  });
  serve<aras_visual_servo_msgs::DeleteLight>(
      node, "sim/delete_light", [this](const auto& request, auto&) { simulation_.deleteLight(request.name); });
  using GetLights = aras_visual_servo_msgs::GetLights;
  services_.push_back(node.advertiseService<GetLights::Request, GetLights::Response>(
      "sim/get_lights", [this](GetLights::Request&, GetLights::Response& response) {
        for (const Light& light : simulation_.lights()) {
          YAML::Emitter text;
          text << YAML::Flow << lightYaml(light);
          response.name.push_back(light.name);
          response.light.push_back(text.c_str());
        }
        return true;
      }));
}

}  // namespace aras_visual_servo_sim
