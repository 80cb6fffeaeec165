#include "aras_visual_servo_sim/simulation/models/model_set.hpp"

#include <algorithm>
#include <set>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "aras_visual_servo_sim/config/section.hpp"

namespace aras_visual_servo_sim {

std::vector<std::string> ModelSet::names() const {
  std::vector<std::string> names;
  for (const PlanarModel& model : scene.models) names.push_back(model.name());
  for (std::size_t k = 0; k < body_links.size(); ++k) {
    if (body_links[k].isSolid()) names.push_back(scene.bodies[k].name);
  }
  return names;
}

const Pose& ModelSet::place(const std::string& model) const {
  for (const PlanarModel& planar : scene.models) {
    if (planar.name() == model) return planar.X_WM;
  }
  for (std::size_t k = 0; k < body_links.size(); ++k) {
    if (body_links[k].isSolid() && scene.bodies[k].name == model) return scene.bodies[k].X_WB;
  }
  const std::vector<std::string> known = names();
  throw UnknownNameError("model '" + model + "' does not exist; models: " + (known.empty() ? "none" : joined(known)));
}

Pose& ModelSet::place(const std::string& model) {
  return const_cast<Pose&>(static_cast<const ModelSet*>(this)->place(model));
}

const Pose& ModelSet::anchored(const std::string& model) const {
  for (const PlanarModel& planar : scene.models) {
    if (planar.name() == model && !planar.carrier.empty()) return planar.X_LM;
  }
  return place(model);
}

Pose& ModelSet::anchored(const std::string& model) {
  return const_cast<Pose&>(static_cast<const ModelSet*>(this)->anchored(model));
}

const std::string& ModelSet::carrier(const std::string& model) const {
  static const std::string kNone;
  for (const PlanarModel& planar : scene.models) {
    if (planar.name() == model) return planar.carrier;
  }
  place(model);  // throws
  return kNone;
}

void ModelSet::checkCarriers(const std::vector<std::string>& links) const {
  for (const PlanarModel& model : scene.models) {
    if (model.carrier.empty() || std::find(links.begin(), links.end(), model.carrier) != links.end()) continue;
    throw ParameterError("model '" + model.name() + "': attached_to: found " + model.carrier + ", allowed " +
                         joined(links));
  }
}

std::map<std::string, Pose> ModelSet::poses() const {
  std::map<std::string, Pose> poses;
  for (const PlanarModel& model : scene.models) poses[model.name()] = model.X_WM;
  for (std::size_t k = 0; k < body_links.size(); ++k) {
    if (body_links[k].isSolid()) poses[scene.bodies[k].name] = scene.bodies[k].X_WB;
  }
  return poses;
}

void ModelSet::remove(const std::string& model) {
  auto& planar = scene.models;
  planar.erase(std::remove_if(planar.begin(), planar.end(), [&](const auto& m) { return m.name() == model; }),
               planar.end());
  for (std::size_t k = 0; k < body_links.size(); ++k) {
    if (!body_links[k].isSolid() || scene.bodies[k].name != model) continue;
    scene.bodies.erase(scene.bodies.begin() + static_cast<std::ptrdiff_t>(k));
    body_links.erase(body_links.begin() + static_cast<std::ptrdiff_t>(k));
    break;
  }
  auto& lights = scene.lighting.lights;
  lights.erase(std::remove_if(lights.begin(), lights.end(), [&](const Light& l) { return l.attached_to == model; }),
               lights.end());
  scene.motions.erase(model);
  starts.erase(model);
  solids.erase(model);
  spawned.erase(model);
}

void ModelSet::removeRobot(int number, const std::vector<std::string>& links) {
  for (std::size_t k = body_links.size(); k-- > 0;) {
    if (body_links[k].robot != number) continue;
    scene.bodies.erase(scene.bodies.begin() + static_cast<std::ptrdiff_t>(k));
    body_links.erase(body_links.begin() + static_cast<std::ptrdiff_t>(k));
  }
  const auto carries = [&](const std::string& name) {
    return std::find(links.begin(), links.end(), name) != links.end();
  };
  auto& lights = scene.lighting.lights;
  lights.erase(std::remove_if(lights.begin(), lights.end(), [&](const Light& l) { return carries(l.attached_to); }),
               lights.end());
  for (const std::string& model : names()) {
    if (carries(carrier(model))) remove(model);
  }
}

std::vector<SavedModel> ModelSet::saved() const {
  std::vector<SavedModel> models;
  for (const std::string& name : names()) {
    const auto entry = spawned.find(name);
    models.push_back({name, entry == spawned.end() ? "" : entry->second, anchored(name), starts.at(name)});
  }
  return models;
}

namespace {

/** @throws ParameterError unless it is a link or a model */
void checkCarrier(const Light& light, const ModelSet& set, const std::vector<std::string>& links) {
  if (light.attached_to.empty() || set.starts.count(light.attached_to) > 0 ||
      std::find(links.begin(), links.end(), light.attached_to) != links.end()) {
    return;
  }
  std::vector<std::string> known = links;
  for (const std::string& model : set.names()) known.push_back(model);
  throw ParameterError("light '" + light.name + "': attached_to: found " + light.attached_to + ", allowed " +
                       joined(known));
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
