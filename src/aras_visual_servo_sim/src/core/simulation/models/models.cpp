#include "aras_visual_servo_sim/simulation/models/models.hpp"

#include <algorithm>
#include <aras_visual_servo_common/files.hpp>
#include <utility>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "aras_visual_servo_sim/config/section.hpp"
#include "aras_visual_servo_sim/scene/scene_loader.hpp"
#include "aras_visual_servo_sim/simulation/models/model_set.hpp"

namespace aras_visual_servo_sim {
namespace {

constexpr double kSecondsPerNs = 1e-9;

TouchableSolid touchable(const SolidEntry& solid, const PackagePaths& packages) {
  return {solid.mass_kg, collisionsOf(solid, packages), solid.touches};
}

YAML::Node descriptionOf(const SavedModel& model) {
  try {
    return aras_visual_servo_common::parseYaml(model.entry, aras_visual_servo_common::kMostFileYaml);
  } catch (const ArasError& error) {
    throw StateError("saved state: description of model '" + model.name + "': " + error.what());
  }
}

}  // namespace

Models::Models(const SceneConfig& config, const PackagePaths& packages) : packages_(packages) {
  set_.scene = loadScene(config, packages);
  for (const SolidEntry& solid : config.solids) set_.solids[solid.name] = touchable(solid, packages);
  set_.body_links.resize(set_.scene.bodies.size());
  for (const std::string& name : set_.names()) set_.starts[name] = set_.anchored(name);
}

/** Changes the present set and that as constructed. Nothing changes if `changed` throws. */
template <typename Changed>
void Models::changeBoth(const Changed& changed) {
  ModelSet next = changed(set_);
  if (built_) built_ = std::make_shared<const ModelSet>(changed(*built_));
  set_ = std::move(next);
}

void Models::addRobot(const RobotModel& robot, const std::string& name, int number) {
  changeBoth([&](ModelSet set) {
    const std::size_t first = set.scene.bodies.size();
    addRobotBodies(robot, packages_, set.scene, name);
    int link = 0;
    for (std::size_t k = first; k < set.scene.bodies.size(); ++k) {
      while (scoped(name, robot.links[link].name) != set.scene.bodies[k].name) ++link;
      set.body_links.push_back({number, link});
    }
    return set;
  });
}

void Models::removeRobot(int number, const std::vector<std::string>& links) {
  changeBoth([&](ModelSet set) {
    set.removeRobot(number, links);
    return set;
  });
}

void Models::start(std::int64_t now_ns) {
  for (const auto& [name, X_AM] : set_.starts) place(name, X_AM);
  motions_.clear();
  for (const auto& [name, motion] : set_.scene.motions) {
    motions_.emplace(name, MotionRun{motion, set_.starts.at(name), now_ns});
  }
}

ModelPlacement Models::at(const MotionRun& run, std::int64_t now_ns) {
  return run.motion.at(run.X_WM0, kSecondsPerNs * static_cast<double>(now_ns - run.start_ns));
}

void Models::move(std::int64_t now_ns) {
  for (const auto& [name, run] : motions_) place(name, at(run, now_ns).X_WM);
}

namespace {

/** The set with background and lights of `next` in the place of those of `before`. @throws as checkLights */
ModelSet relit(ModelSet set, const SceneConfig& before, const SceneConfig& next,
               const std::vector<std::string>& links) {
  std::vector<Light> lights = next.lighting.lights;
  for (const Light& light : set.scene.lighting.lights) {
    if (!before.lighting.find(light.name) && !next.lighting.find(light.name)) lights.push_back(light);
  }
  set.scene.background = next.background;
  set.scene.light_direction_W = next.light_direction_W;
  set.scene.lighting = next.lighting;
  set.scene.lighting.lights = std::move(lights);
  checkLights(set, links);
  return set;
}

}  // namespace

void Models::setLighting(const SceneConfig& before, const SceneConfig& next, const std::vector<std::string>& links) {
  changeBoth([&](const ModelSet& set) { return relit(set, before, next, links); });
}

bool Models::anyCarried() const {
  const auto& models = set_.scene.models;
  return std::any_of(models.begin(), models.end(), [](const PlanarModel& model) { return !model.carrier.empty(); });
}

void Models::carry(const LinkPoses& links) {
  for (PlanarModel& model : set_.scene.models) {
    if (!model.carrier.empty()) model.X_WM = links.of_name(model.carrier) * model.X_LM;
  }
}

void Models::follow(const LinkPoses& links) {
  carry(links);
  for (std::size_t k = 0; k < set_.body_links.size(); ++k) {
    const BodyLink& shown = set_.body_links[k];
    if (!shown.isSolid()) set_.scene.bodies[k].X_WB = links.shown(shown);
  }
  for (Light& light : set_.scene.lighting.lights) {
    if (light.attached_to.empty()) continue;
    const bool on_model = set_.starts.count(light.attached_to) > 0;
    light.carry(on_model ? set_.place(light.attached_to) : links.of_name(light.attached_to));
  }
}

void Models::setMotion(const std::string& model, const std::optional<ModelMotion>& motion, std::int64_t now_ns) {
  const Pose& X_WM = pose(model);
  if (motion && !carrier(model).empty()) {
    throw ParameterError("model '" + model +
                         "': found a motion, allowed of a model that no link carries; this one is " + "attached to '" +
                         carrier(model) + "'");
  }
  motions_.erase(model);
  if (!motion) return;
  motions_.emplace(model, MotionRun{*motion, X_WM, now_ns});
  move(now_ns);
}

void Models::add(ModelSet& set, const SceneEntry& entry, const std::string& yaml) const {
  loadSceneEntry(entry, packages_, set.scene);
  if (const auto* solid = std::get_if<SolidEntry>(&entry)) {
    set.body_links.emplace_back();
    set.solids[solid->name] = touchable(*solid, packages_);
  }
  set.spawned[nameOf(entry)] = yaml;
}

ModelSet Models::with(const SceneEntry& entry, const std::string& yaml, const std::optional<Pose>& X_AM) const {
  const std::string& name = nameOf(entry);
  const std::vector<std::string> taken = names();
  if (std::find(taken.begin(), taken.end(), name) != taken.end() || scene().findBody(name)) {
    throw ParameterError("model '" + name + "': a model or link of this name exists, allowed: another name");
  }
  if (X_AM) checkPlace("model '" + name + "'", *X_AM);
  ModelSet next = set_;
  add(next, entry, yaml);
  if (X_AM) next.anchored(name) = *X_AM;
  next.starts[name] = next.anchored(name);
  return next;
}

ModelSet Models::without(const std::string& model) const {
  pose(model);  // throws
  ModelSet next = set_;
  next.remove(model);
  return next;
}

ModelSet Models::composed(const std::vector<SavedModel>& saved) const {
  ModelSet set = built();
  for (const std::string& name : built().names()) {
    const auto same = [&name](const SavedModel& model) { return model.name == name && model.entry.empty(); };
    if (std::none_of(saved.begin(), saved.end(), same)) set.remove(name);
  }
  for (const SavedModel& model : saved) {
    if (!model.entry.empty()) {
      add(set, sceneEntryFromYaml(descriptionOf(model)), model.entry);
    } else if (built().starts.count(model.name) == 0) {
      throw StateError("saved state: found model '" + model.name + "', which is not in this scene");
    }
    set.starts[model.name] = model.X_AM0;
  }
  for (const SavedModel& model : saved) set.anchored(model.name) = model.X_AM;
  return set;
}

void Models::become(ModelSet next) {
  if (!built_) built_ = std::make_shared<const ModelSet>(std::move(set_));
  set_ = std::move(next);
  for (auto run = motions_.begin(); run != motions_.end();) {
    run = set_.starts.count(run->first) > 0 ? std::next(run) : motions_.erase(run);
  }
}

void Models::become(ModelSet next, std::map<std::string, MotionRun> motions) {
  become(std::move(next));
  motions_ = std::move(motions);
}

void Models::reset() {
  if (built_) set_ = *built_;
}

}  // namespace aras_visual_servo_sim
