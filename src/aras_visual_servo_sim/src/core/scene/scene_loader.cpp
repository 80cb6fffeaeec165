#include "aras_visual_servo_sim/scene/scene_loader.hpp"

#include <aras_visual_servo_common/files.hpp>
#include <filesystem>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "aras_visual_servo_sim/config/section.hpp"
#include "scene/mesh/mesh_cache.hpp"
#include "scene_settings.hpp"

namespace aras_visual_servo_sim {
namespace {

YAML::Node modelFile(const std::string& path) {
  namespace common = aras_visual_servo_common;
  try {
    return common::parseYaml(common::readFile(path, common::kMostFileYaml), common::kMostFileYaml);
  } catch (const ArasError& error) {
    throw ModelError("file '" + path + "': " + error.what());
  }
}

/** The model of such a shape, its picture loaded: a plain name is relative to base_dir. @throws ModelError */
PlanarModel planarModelOf(const std::string& name, const PlanarShape& shape, const PackagePaths& packages,
                          const std::string& base_dir = "") {
  std::optional<PlanarModel::Picture> picture;
  if (shape.picture) {
    picture = {loadTexture(packages.resolve(shape.picture->file, base_dir)), shape.picture->size_m};
  }
  return {name, shape.outlines, shape.color, shape.board, picture};
}

PlanarModel modelOf(const ModelEntry& entry, const PackagePaths& packages) {
  if (entry.file.empty()) return planarModelOf(entry.name, entry.shape, packages);
  const PlanarModel loaded = loadPlanarModel(packages.resolve(entry.file), packages);
  return {entry.name, loaded.outlines(), loaded.color(), loaded.board(), loaded.picture()};
}

void add(const ModelEntry& entry, const PackagePaths& packages, Scene& scene) {
  scene.models.push_back(modelOf(entry, packages));
  scene.models.back().X_WM = scene.models.back().X_LM = entry.X_WM;
  scene.models.back().carrier = entry.carrier;
  scene.models.back().visible = entry.visible;
  if (entry.motion) scene.motions.emplace(entry.name, *entry.motion);
}

void add(const SolidEntry& entry, const PackagePaths& packages, MeshCache& meshes, Scene& scene) {
  Body body;
  if (entry.urdf.empty()) {
    body.name = entry.name;
    // The solid's own material counts, else those of its mesh file.
    const bool own = !isPlain(entry.material);
    const auto parts =
        own ? std::vector<MaterialMesh>{{meshes.of(entry.geometry), Material{}}} : meshes.partsOf(entry.geometry);
    for (const MaterialMesh& part : parts) {
      Material material = isPlain(part.material) ? entry.material : part.material;
      material.ambient_share = entry.material.ambient_share;  // which files do not say
      body.shapes.push_back({Pose{}, shared(part.mesh), entry.color, material});
    }
  } else {
    body = bodyFromUrdf(entry.name, entry.urdf, packages, &scene.lighting.lights);
  }
  body.X_WB = entry.X_WB;
  body.casts_shadows = entry.casts_shadows;
  scene.bodies.push_back(std::move(body));
  if (entry.motion) scene.motions.emplace(entry.name, *entry.motion);
}

}  // namespace

PlanarModel planarModelFromYaml(const YAML::Node& node, const std::string& source_name, const PackagePaths& packages,
                                const std::string& base_dir) {
  const auto target = readSection<TargetConfig>(
      node, "", [](auto&&...) {}, source_name);
  return planarModelOf(target.name, planarShapeOf(target), packages, base_dir);
}

PlanarModel loadPlanarModel(const std::string& path, const PackagePaths& packages) {
  return planarModelFromYaml(modelFile(path), path, packages, std::filesystem::path(path).parent_path().string());
}

Scene loadScene(const SceneConfig& config, const PackagePaths& packages) {
  Scene scene;
  scene.background = config.background;
  scene.light_direction_W = config.light_direction_W;
  scene.lighting = config.lighting;
  for (const ModelEntry& entry : config.models) add(entry, packages, scene);
  MeshCache meshes(packages);
  for (const SolidEntry& entry : config.solids) add(entry, packages, meshes, scene);
  return scene;
}

void loadSceneEntry(const SceneEntry& entry, const PackagePaths& packages, Scene& scene) {
  if (const auto* model = std::get_if<ModelEntry>(&entry)) return add(*model, packages, scene);
  MeshCache meshes(packages);
  add(std::get<SolidEntry>(entry), packages, meshes, scene);
}

std::vector<Collision> collisionsOf(const SolidEntry& solid, const PackagePaths& packages) {
  if (!solid.urdf.empty()) return collisionsFromUrdf(solid.name, solid.urdf, packages);
  return {{solid.geometry, Pose{}}};
}

}  // namespace aras_visual_servo_sim
