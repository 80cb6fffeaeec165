#include "aras_visual_servo_sim/scene/scene_config.hpp"

#include <algorithm>

#include "aras_visual_servo_sim/config/yaml_reader.hpp"
#include "planar_shape.hpp"

namespace aras_visual_servo_sim {
namespace {

Pose readPose(YamlReader& reader) {
  Pose pose;
  pose.p = reader.optional<Eigen::Vector3d>("position_m", Eigen::Vector3d::Zero());
  pose.q = quaternionFromRpy(reader.optional<Eigen::Vector3d>("rpy_rad", Eigen::Vector3d::Zero()));
  return pose;
}

Geometry readGeometry(YamlReader& reader) {
  Geometry geometry;
  int kinds = 0;
  if (reader.has("box_m")) {
    geometry.type = Geometry::Type::kBox;
    geometry.size_m = reader.required<Eigen::Vector3d>("box_m", Range::positive());
    ++kinds;
  }
  if (reader.has("cylinder_m")) {
    geometry.type = Geometry::Type::kCylinder;
    const auto size = reader.required<std::vector<double>>("cylinder_m", Range::positive());
    if (size.size() == 2) {
      geometry.radius_m = size[0];
      geometry.length_m = size[1];
    } else {
      reader.fault("cylinder_m", std::to_string(size.size()) + " numbers", "two, radius and length");
    }
    ++kinds;
  }
  if (reader.has("sphere_m")) {
    geometry.type = Geometry::Type::kSphere;
    geometry.radius_m = reader.required<double>("sphere_m", Range::positive());
    ++kinds;
  }
  if (reader.has("mesh")) {
    geometry.type = Geometry::Type::kMesh;
    geometry.filename = reader.required<std::string>("mesh");
    geometry.scale = reader.optional<Eigen::Vector3d>("scale", Eigen::Vector3d::Ones());
    ++kinds;
  }
  if (kinds != 1) {
    reader.fault("shape", std::to_string(kinds) + " of them", "one of box_m, cylinder_m, sphere_m, mesh, urdf");
  }
  return geometry;
}

std::optional<ModelMotion> readMotion(YamlReader& reader) {
  if (!reader.has("motion")) return std::nullopt;
  YamlReader section = reader.section("motion");
  return ModelMotion::read(section, reader.raw("motion"));
}

ModelEntry readModel(YamlReader& reader) {
  ModelEntry entry;
  entry.name = reader.required<std::string>("name");
  entry.file = reader.optional<std::string>("file", "");
  entry.X_WM = readPose(reader);
  entry.visible = reader.optional<bool>("visible", true);
  entry.motion = readMotion(reader);
  if (entry.file.empty()) entry.shape = readPlanarShape(reader);
  return entry;
}

/** A name, or a list of names. */
std::vector<std::string> readTouches(YamlReader& reader) {
  if (!reader.has("touches")) return {};
  const YAML::Node touches = reader.raw("touches");
  if (touches.IsScalar()) return {touches.Scalar()};
  bool good = touches.IsSequence();
  std::vector<std::string> names;
  for (std::size_t k = 0; good && k < touches.size(); ++k) {
    good = touches[k].IsScalar();
    if (good) names.push_back(touches[k].Scalar());
  }
  if (!good) reader.fault("touches", "something else", "all, robot, or a list of links and solids by name");
  return names;
}

SolidEntry readSolid(YamlReader& reader) {
  SolidEntry entry;
  entry.name = reader.required<std::string>("name");
  entry.color = readColor(reader, "color_rgb", {128, 128, 128});
  entry.X_WB = readPose(reader);
  entry.motion = readMotion(reader);
  entry.urdf = reader.optional<std::string>("urdf", "");
  if (entry.urdf.empty()) entry.geometry = readGeometry(reader);
  entry.mass_kg = reader.optional<double>("mass_kg", 0.0, Range::positive());
  if (reader.has("mass_kg") && reader.has("urdf")) {
    reader.fault("mass_kg", "it beside urdf", "it with one shape: box_m, cylinder_m, sphere_m or mesh");
  }
  entry.touches = readTouches(reader);
  return entry;
}

template <typename Entry>
void requireDistinct(const std::vector<Entry>& entries, const char* key, YamlReader& reader) {
  for (std::size_t i = 0; i < entries.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (entries[i].name == entries[j].name)
        reader.fault(key, "two named '" + entries[i].name + "'", "distinct names");
    }
  }
}

}  // namespace

SceneConfig SceneConfig::fromYaml(const YAML::Node& node) {
  SceneConfig scene;
  YamlReader reader(node, "scene");
  scene.background = readColor(reader, "background_rgb", scene.background);
  scene.light_direction_W = reader.optional<Eigen::Vector3d>("light_direction", scene.light_direction_W);
  if (scene.light_direction_W.norm() == 0.0) reader.fault("light_direction", "zero", "any other direction");
  for (YamlReader& entry : reader.list("models")) scene.models.push_back(readModel(entry));
  for (YamlReader& entry : reader.list("solids")) scene.solids.push_back(readSolid(entry));
  requireDistinct(scene.models, "models", reader);
  requireDistinct(scene.solids, "solids", reader);
  for (const SolidEntry& solid : scene.solids) {
    const auto same = [&](const ModelEntry& model) { return model.name == solid.name; };
    if (std::any_of(scene.models.begin(), scene.models.end(), same)) {
      reader.fault("solids", "one named '" + solid.name + "' as a model is", "distinct names");
    }
  }
  reader.finish();
  return scene;
}

}  // namespace aras_visual_servo_sim
