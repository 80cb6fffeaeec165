#include "aras_visual_servo_sim/render/undrawn.hpp"

#include <algorithm>

namespace aras_visual_servo_sim {
namespace {

void addShape(const Shape& shape, const std::string& body, Undrawn& undrawn) {
  const Material &material = shape.material, usual;
  const auto add = [&](bool there, const char* part) {
    if (there) undrawn[part].insert(body);
  };
  add(material.ambient || material.ambient_share != usual.ambient_share, "ambient colour");
  add(material.specular != usual.specular, "specular");
  add(material.emissive != usual.emissive, "emissive");
  add(material.opacity != usual.opacity, "opacity");
  add(material.two_sided != usual.two_sided, "the back of two-sided faces");
  const std::vector<MeshPicture>& pictures = shape.mesh->pictures;
  add(std::any_of(pictures.begin(), pictures.end(), [](const MeshPicture& each) { return each.normals != nullptr; }),
      "normal map");
}

}  // namespace

Undrawn undrawnByCoverage(const Scene& scene) {
  Undrawn undrawn;
  for (const Body& body : scene.bodies) {
    for (const Shape& shape : body.shapes) addShape(shape, body.name, undrawn);
  }
  const Lighting& lighting = scene.lighting;
  for (const Light& light : lighting.lights) {
    undrawn["light"].insert(light.name);
    if (lighting.shadows && light.casts_shadows) undrawn["shadows"].insert(light.name);
  }
  if (lighting.fog) undrawn["fog"].insert("");
  if (lighting.zenith) undrawn["sky"].insert("");
  return undrawn;
}

std::string textOf(const Undrawn& undrawn) {
  std::string text;
  for (const auto& [part, names] : undrawn) {
    text += (text.empty() ? "" : "; ") + part;
    const char* before = " of ";
    for (const std::string& name : names) {
      if (name.empty()) continue;
      text += before + name;
      before = ", ";
    }
  }
  return text;
}

}  // namespace aras_visual_servo_sim
