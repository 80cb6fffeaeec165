#include "aras_visual_servo_sim/scene/scene_config.hpp"

#include <algorithm>
#include <set>

#include "aras_visual_servo_sim/config/section.hpp"
#include "planar_shape.hpp"
#include "scene/light/lighting_reader.hpp"

namespace aras_visual_servo_sim {
namespace {

Pose readPose(YamlReader& reader) {
  return {reader.get<Eigen::Vector3d>("position_m"), quaternionFromRpy(reader.get<Eigen::Vector3d>("rpy_rad"))};
}

/** The one shape of a solid; the section sees to it that it has one. */
Geometry readGeometry(YamlReader& reader) {
  Geometry geometry;
  if (reader.has("box_m")) {
    geometry.size_m = reader.get<Eigen::Vector3d>("box_m");
  } else if (reader.has("cylinder_m")) {
    geometry.type = Geometry::Type::kCylinder;
    const auto size = reader.get<Eigen::Vector2d>("cylinder_m");
    geometry.radius_m = size[0];
    geometry.length_m = size[1];
  } else if (reader.has("cone_m")) {
    geometry.type = Geometry::Type::kCone;
    const auto size = reader.get<Eigen::Vector2d>("cone_m");
    geometry.radius_m = size[0];
    geometry.length_m = size[1];
    geometry.size_m = {2.0 * size[0], 2.0 * size[0], size[1]};
  } else if (reader.has("sphere_m")) {
    geometry.type = Geometry::Type::kSphere;
    geometry.radius_m = reader.get<double>("sphere_m");
  } else if (reader.has("mesh")) {
    geometry.type = Geometry::Type::kMesh;
    geometry.filename = reader.get<std::string>("mesh");
    geometry.scale = reader.get<Eigen::Vector3d>("scale");
  }
  return geometry;
}

std::optional<ModelMotion> readMotion(YamlReader& reader) {
  if (!reader.has("motion")) return std::nullopt;
  return ModelMotion::read(reader.section("motion"), reader.raw("motion"));
}

ModelEntry readModel(YamlReader& reader) {
  ModelEntry entry;
  entry.name = reader.get<std::string>("name");
  entry.file = reader.find<std::string>("file").value_or("");
  entry.X_WM = readPose(reader);
  entry.visible = reader.get<bool>("visible");
  entry.carrier = reader.find<std::string>("attached_to").value_or("");
  entry.motion = readMotion(reader);
  if (entry.motion && !entry.carrier.empty())
    reader.fault("motion", "it together with attached_to", "one of the two, because the link moves the model");
  entry.shape = readPlanarShape(reader);
  for (const char* key : {"color_rgb", "outlines_m", "image", "board"}) {
    if (reader.has("file") && reader.has(key))
      reader.fault(key, "it together with file", "one of the two, because the file holds the shape");
  }
  return entry;
}

/** A name, or a list of names. */
std::vector<std::string> readTouches(YamlReader& reader) {
  const auto touches = reader.get<YAML::Node>("touches");
  if (touches.IsScalar()) return {touches.Scalar()};
  std::vector<std::string> names;
  for (const auto& name : touches) names.push_back(name.IsScalar() ? name.Scalar() : "");
  return names;
}

SolidEntry readSolid(YamlReader& reader) {
  SolidEntry entry;
  entry.name = reader.get<std::string>("name");
  entry.color = readColor(reader, "color_rgb");
  YamlReader material = reader.section("material");
  entry.material = readMaterial(material);
  entry.casts_shadows = material.get<bool>("casts_shadows");
  entry.X_WB = readPose(reader);
  entry.motion = readMotion(reader);
  entry.urdf = reader.find<std::string>("urdf").value_or("");
  entry.geometry = readGeometry(reader);
  entry.mass_kg = reader.find<double>("mass_kg").value_or(0.0);
  entry.touches = readTouches(reader);
  if (reader.has("mass_kg") && reader.has("urdf")) {
    reader.fault("mass_kg", "it together with urdf", "it with box_m, cylinder_m, cone_m, sphere_m or mesh only");
  }
  if (reader.has("scale") && !reader.has("mesh")) reader.fault("scale", "it without mesh", "it with mesh only");
  return entry;
}

/** Two of one name are a fault; that a name is missing was said already. */
template <typename Entry>
void requireDistinct(const std::vector<Entry>& entries, const char* key, YamlReader& reader) {
  std::set<std::string> names;
  for (const Entry& entry : entries) {
    if (!entry.name.empty() && !names.insert(entry.name).second)
      reader.fault(key, "two named '" + entry.name + "'", "distinct names");
  }
}

}  // namespace

SceneConfig SceneConfig::read(YamlReader reader) {
  SceneConfig scene;
  scene.background = readColor(reader, "background_rgb");
  scene.light_direction_W = reader.get<Eigen::Vector3d>("light_direction");
  if (scene.light_direction_W.norm() == 0.0) reader.fault("light_direction", "zero", "any other direction");
  YamlReader lighting = reader.section("lighting");
  scene.lighting = readLighting(lighting);
  scene.has_lights = lighting.has("lights");
  scene.has_background = reader.has("background_rgb");
  for (YamlReader& entry : reader.list("models")) scene.models.push_back(readModel(entry));
  for (YamlReader& entry : reader.list("solids")) scene.solids.push_back(readSolid(entry));
  requireDistinct(scene.models, "models", reader);
  requireDistinct(scene.lighting.lights, "lighting/lights", reader);
  requireDistinct(scene.solids, "solids", reader);
  for (const SolidEntry& solid : scene.solids) {
    const auto same = [&](const ModelEntry& model) { return model.name == solid.name; };
    if (std::any_of(scene.models.begin(), scene.models.end(), same)) {
      reader.fault("solids", "a solid and a model named '" + solid.name + "'", "distinct names");
    }
  }
  return scene;
}

SceneConfig SceneConfig::fromYaml(const YAML::Node& node) {
  YamlReader reader(node, sectionOf("scene"), "scene");
  SceneConfig scene = read(reader);
  reader.finish();
  return scene;
}

}  // namespace aras_visual_servo_sim
