#include "aras_visual_servo_sim/scene/scene.hpp"

#include <algorithm>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "aras_visual_servo_sim/config/section.hpp"
#include "scene_settings.hpp"

namespace aras_visual_servo_sim {
namespace {

template <typename Container, typename Name>
std::string listOf(const Container& items, const Name& name) {
  std::string text;
  for (const auto& item : items) text += (text.empty() ? "" : ", ") + name(item);
  return text.empty() ? "none" : text;
}

}  // namespace

Scene::Scene() : background(colorOf(SceneKeys().background_rgb)), light_direction_W(SceneKeys().light_direction) {}

PlanarModel& Scene::model(const std::string& name) {
  return const_cast<PlanarModel&>(static_cast<const Scene*>(this)->model(name));
}

const PlanarModel& Scene::model(const std::string& name) const {
  const auto found =
      std::find_if(models.begin(), models.end(), [&](const PlanarModel& model) { return model.name() == name; });
  if (found != models.end()) return *found;
  throw UnknownNameError("model '" + name + "' does not exist; models: " + listOf(models, [](const PlanarModel& model) {
                           return model.name();
                         }));
}

Body& Scene::body(const std::string& name) {
  if (const auto index = findBody(name)) return bodies[*index];
  throw UnknownNameError("body '" + name +
                         "' does not exist; bodies: " + listOf(bodies, [](const Body& body) { return body.name; }));
}

std::optional<std::size_t> Scene::findBody(const std::string& name) const {
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (bodies[i].name == name) return i;
  }
  return std::nullopt;
}

}  // namespace aras_visual_servo_sim
