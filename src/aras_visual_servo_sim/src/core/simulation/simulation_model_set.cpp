// Models of a Simulation that come and go.
#include <algorithm>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "aras_visual_servo_sim/scene/scene_loader.hpp"
#include "aras_visual_servo_sim/simulation/simulation.hpp"

namespace aras_visual_servo_sim {

void Simulation::keepBuilt() {
  if (!built_) built_ = std::make_unique<const ModelSet>(models_);
}

void Simulation::spawnModel(const YAML::Node& entry, const std::optional<Pose>& X_WM) {
  Scene added = loadSceneEntry(entry, packages_);
  const std::string name = added.models.empty() ? added.bodies.front().name : added.models.front().name();
  const std::vector<std::string> taken = modelNames();
  if (std::find(taken.begin(), taken.end(), name) != taken.end() || models_.scene.findBody(name)) {
    throw ParameterError("model '" + name + "': a model or link of this name exists, allowed: another name");
  }
  if (X_WM && (!X_WM->p.allFinite() || !X_WM->q.coeffs().allFinite())) {
    throw NotFiniteError("model '" + name + "': pose is not finite");
  }
  YAML::Emitter text;
  text << YAML::Flow << entry;
  ModelSet next = models_;
  next.spawned[name] = text.c_str();
  next.starts[name] = X_WM ? *X_WM : added.models.empty() ? added.bodies.front().X_WB : added.models.front().X_WM;
  const bool solid = added.models.empty();
  addModel(next, std::move(added));
  if (solid) {
    checkTouched(entry, next);
    touch(next);
  }
  keepBuilt();
  keepSeenModels();
  models_ = std::move(next);
  forgetPast();
  placeOf(name) = models_.starts[name];
  const auto motion = models_.scene.motions.find(name);
  if (motion != models_.scene.motions.end()) setModelMotion(name, motion->second);
}

/** The models of a scene without a robot, after those of the set. */
void Simulation::addModel(ModelSet& set, Scene added) {
  for (PlanarModel& model : added.models) set.scene.models.push_back(std::move(model));
  for (Body& body : added.bodies) {
    set.scene.bodies.push_back(std::move(body));
    set.body_links.push_back(-1);
  }
  for (auto& [name, motion] : added.motions) set.scene.motions.emplace(name, std::move(motion));
}

void Simulation::deleteModel(const std::string& model) {
  placeOf(model);  // throws
  ModelSet next = models_;
  removeModel(next, model);
  if (touches(model)) touch(next);
  keepBuilt();
  keepSeenModels();
  models_ = std::move(next);
  forgetPast();
  motions_.erase(model);
}

void Simulation::removeModel(ModelSet& set, const std::string& model) {
  auto& planar = set.scene.models;
  planar.erase(std::remove_if(planar.begin(), planar.end(), [&](const auto& m) { return m.name() == model; }),
               planar.end());
  for (std::size_t k = 0; k < set.body_links.size(); ++k) {
    if (set.body_links[k] >= 0 || set.scene.bodies[k].name != model) continue;
    set.scene.bodies.erase(set.scene.bodies.begin() + static_cast<std::ptrdiff_t>(k));
    set.body_links.erase(set.body_links.begin() + static_cast<std::ptrdiff_t>(k));
    break;
  }
  set.scene.motions.erase(model);
  set.starts.erase(model);
  set.spawned.erase(model);
}

/** The models as they were when a state was saved. @throws StateError if one is neither built in nor was spawned */
ModelSet Simulation::composed(const std::vector<SavedModel>& saved) const {
  ModelSet set = built_ ? *built_ : models_;
  const std::map<std::string, Pose> built = set.starts;
  for (const auto& [name, X_WM] : built) {
    const auto same = [&name = name](const SavedModel& model) { return model.name == name && model.entry.empty(); };
    if (std::none_of(saved.begin(), saved.end(), same)) removeModel(set, name);
  }
  for (const SavedModel& model : saved) {
    if (!model.entry.empty()) {
      addModel(set, loadSceneEntry(YAML::Load(model.entry), packages_));
      set.spawned[model.name] = model.entry;
    } else if (built.count(model.name) == 0) {
      throw StateError("saved state: model '" + model.name + "' is not in this scene");
    }
    set.starts[model.name] = model.X_WM0;
  }
  return set;
}

}  // namespace aras_visual_servo_sim
