#include "light_services.hpp"

#include <yaml-cpp/yaml.h>

#include "aras_visual_servo_sim/scene/light_entry.hpp"
#include "convert/answer.hpp"

namespace aras_visual_servo_sim {

LightServices::LightServices(ros::NodeHandle& node, Simulation& simulation) : simulation_(simulation) {
  services_ = {node.advertiseService("sim/set_light", &LightServices::onSet, this),
               node.advertiseService("sim/delete_light", &LightServices::onDelete, this),
               node.advertiseService("sim/get_lights", &LightServices::onGet, this)};
}

bool LightServices::onSet(SetLight::Request& request, SetLight::Response& response) {
  return answer(response, [&] { simulation_.setLight(lightFromText(request.light)); });
}

bool LightServices::onDelete(DeleteLight::Request& request, DeleteLight::Response& response) {
  return answer(response, [&] { simulation_.deleteLight(request.name); });
}

bool LightServices::onGet(GetLights::Request&, GetLights::Response& response) {
  for (const Light& light : simulation_.lights()) {
    YAML::Emitter text;
    text << YAML::Flow << lightYaml(light);
    response.name.push_back(light.name);
    response.light.push_back(text.c_str());
  }
  return true;
}

}  // namespace aras_visual_servo_sim
