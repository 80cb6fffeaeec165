// The models of a Simulation's scene: where they are and how they move.
#include "aras_visual_servo_sim/config/errors.hpp"
#include "aras_visual_servo_sim/simulation/simulation.hpp"

namespace aras_visual_servo_sim {

std::vector<std::string> Simulation::modelNames() const {
  std::vector<std::string> names;
  for (const PlanarModel& model : models_.scene.models) names.push_back(model.name());
  for (std::size_t k = 0; k < models_.body_links.size(); ++k) {
    if (models_.body_links[k] < 0) names.push_back(models_.scene.bodies[k].name);
  }
  return names;
}

Pose& Simulation::placeOf(const std::string& model) {
  for (PlanarModel& planar : models_.scene.models) {
    if (planar.name() == model) return planar.X_WM;
  }
  for (std::size_t k = 0; k < models_.body_links.size(); ++k) {
    if (models_.body_links[k] < 0 && models_.scene.bodies[k].name == model) return models_.scene.bodies[k].X_WB;
  }
  std::string known;
  for (const std::string& name : modelNames()) known += (known.empty() ? "" : ", ") + name;
  throw UnknownNameError("model '" + model + "' does not exist; models: " + (known.empty() ? "none" : known));
}

Pose Simulation::modelPose(const std::string& model) const { return const_cast<Simulation*>(this)->placeOf(model); }

Twist Simulation::modelTwist(const std::string& model) const {
  modelPose(model);  // throws
  const auto run = motions_.find(model);
  if (run == motions_.end()) return touches(model) ? world_->obstacleTwist(model) : Twist(Twist::Zero());
  const double t_s = 1e-9 * static_cast<double>(timeNs() - run->second.start_ns);
  return run->second.motion.at(run->second.X_WM0, t_s).V_WM_W;
}

void Simulation::setModelPose(const std::string& model, const Pose& X_WM) {
  if (!X_WM.p.allFinite() || !X_WM.q.coeffs().allFinite()) {
    throw NotFiniteError("model '" + model + "': pose is not finite");
  }
  Pose& place = placeOf(model);
  place = X_WM;
  place.q.normalize();
  motions_.erase(model);
  touchModel(model);
  forgetPast();
}

void Simulation::setModelMotion(const std::string& model, const std::optional<ModelMotion>& motion) {
  const Pose& place = placeOf(model);
  motions_.erase(model);
  if (!motion) return;
  motions_.emplace(model, MotionRun{*motion, place, timeNs()});
  moveModels();
}

/** Every model where it started, the configured motions from now on. */
void Simulation::startModels() {
  for (const auto& [name, X_WM] : models_.starts) placeOf(name) = X_WM;
  for (const auto& [name, X_WM] : models_.starts) touchModel(name);
  motions_.clear();
  for (const auto& [name, motion] : models_.scene.motions) {
    motions_.emplace(name, MotionRun{motion, models_.starts.at(name), timeNs()});
  }
  moveModels();
}

void Simulation::moveModels() {
  for (const auto& [name, run] : motions_) {
    placeOf(name) = run.motion.at(run.X_WM0, 1e-9 * static_cast<double>(timeNs() - run.start_ns)).X_WM;
  }
}

}  // namespace aras_visual_servo_sim
