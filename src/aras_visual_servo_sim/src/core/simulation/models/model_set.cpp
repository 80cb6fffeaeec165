#include "aras_visual_servo_sim/simulation/models/model_set.hpp"

#include <algorithm>

#include "aras_visual_servo_sim/config/errors.hpp"

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
  std::string known;
  for (const std::string& name : names()) known += (known.empty() ? "" : ", ") + name;
  throw UnknownNameError("model '" + model + "' does not exist; models: " + (known.empty() ? "none" : known));
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
  std::string known;
  for (const std::string& link : links) known += (known.empty() ? "" : ", ") + link;
  for (const PlanarModel& model : scene.models) {
    if (model.carrier.empty() || std::find(links.begin(), links.end(), model.carrier) != links.end()) continue;
    throw ParameterError("model '" + model.name() + "': attached_to: found " + model.carrier + ", allowed " + known);
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

}  // namespace aras_visual_servo_sim
