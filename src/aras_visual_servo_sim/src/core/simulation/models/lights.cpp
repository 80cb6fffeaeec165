#include "aras_visual_servo_sim/simulation/models/lights.hpp"

#include <algorithm>
#include <set>

#include "aras_visual_servo_sim/config/errors.hpp"

namespace aras_visual_servo_sim {
namespace {

/** @throws ParameterError unless it is a link or a model */
void checkCarrier(const Light& light, const ModelSet& set, const std::vector<std::string>& links) {
  if (light.attached_to.empty() || set.starts.count(light.attached_to) > 0 ||
      std::find(links.begin(), links.end(), light.attached_to) != links.end()) {
    return;
  }
  std::string known;
  for (const std::string& link : links) known += (known.empty() ? "" : ", ") + link;
  for (const std::string& model : set.names()) known += (known.empty() ? "" : ", ") + model;
  throw ParameterError("light '" + light.name + "': attached_to: found " + light.attached_to + ", allowed " + known);
}

}  // namespace

void checkLights(const ModelSet& set, const std::vector<std::string>& links) {
  const std::vector<Light>& lights = set.scene.lighting.lights;
  std::set<std::string> names;
  for (const Light& light : lights) {
    checkCarrier(light, set, links);
    if (!names.insert(light.name).second) {
      throw ParameterError("light '" + light.name + "': found two of this name, allowed distinct names");
    }
  }
  if (lights.size() > Lighting::kMostLights) {
    throw ParameterError("lights: found " + std::to_string(lights.size()) + ", allowed up to " +
                         std::to_string(Lighting::kMostLights));
  }
}

ModelSet withLight(const ModelSet& set, const Light& light, const std::vector<std::string>& links) {
  ModelSet next = set;
  std::vector<Light>& lights = next.scene.lighting.lights;
  if (const auto found = next.scene.lighting.find(light.name)) {
    lights[*found] = light;
  } else {
    lights.push_back(light);
  }
  checkLights(next, links);
  return next;
}

const Light& lightOf(const ModelSet& set, const std::string& name) {
  const Lighting& lighting = set.scene.lighting;
  if (const auto found = lighting.find(name)) return lighting.lights[*found];
  std::string known;
  for (const Light& light : lighting.lights) known += (known.empty() ? "" : ", ") + light.name;
  throw UnknownNameError("light '" + name + "' does not exist; lights: " + (known.empty() ? "none" : known));
}

ModelSet withoutLight(const ModelSet& set, const std::string& name) {
  lightOf(set, name);  // throws
  ModelSet next = set;
  std::vector<Light>& lights = next.scene.lighting.lights;
  lights.erase(lights.begin() + static_cast<std::ptrdiff_t>(*next.scene.lighting.find(name)));
  return next;
}

}  // namespace aras_visual_servo_sim
