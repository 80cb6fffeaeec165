#include "aras_visual_servo_sim/simulation/cameras/moment.hpp"

namespace aras_visual_servo_sim {

Moment momentOf(std::int64_t tick, const Pose& X_WC, const Scene& scene) {
  Moment moment{tick, X_WC, {}, {}, {}};
  for (const PlanarModel& model : scene.models) moment.models.push_back(model.X_WM);
  for (const Body& body : scene.bodies) moment.bodies.push_back(body.X_WB);
  for (const Light& light : scene.lighting.lights) {
    if (!light.attached_to.empty()) moment.lights.push_back(light.X_WA);
  }
  return moment;
}

void show(const Moment& moment, Scene& scene) {
  for (std::size_t k = 0; k < moment.models.size(); ++k) scene.models[k].X_WM = moment.models[k];
  for (std::size_t k = 0; k < moment.bodies.size(); ++k) scene.bodies[k].X_WB = moment.bodies[k];
  auto carrier = moment.lights.begin();
  for (Light& light : scene.lighting.lights) {
    if (!light.attached_to.empty() && carrier != moment.lights.end()) light.carry(*carrier++);
  }
}

std::map<std::string, Pose> modelPoses(const Moment& moment, const ModelSet& set) {
  std::map<std::string, Pose> poses;
  for (std::size_t k = 0; k < moment.models.size(); ++k) poses[set.scene.models[k].name()] = moment.models[k];
  for (std::size_t k = 0; k < moment.bodies.size(); ++k) {
    if (set.body_links[k].isSolid()) poses[set.scene.bodies[k].name] = moment.bodies[k];
  }
  return poses;
}

}  // namespace aras_visual_servo_sim
