// What a robot's <visual> tags look like.
#include <algorithm>
#include <cmath>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "aras_visual_servo_sim/scene/light_entry.hpp"
#include "aras_visual_servo_sim/scene/scene_loader.hpp"
#include "scene/mesh/mesh_cache.hpp"

namespace aras_visual_servo_sim {

namespace {

Eigen::Vector3d intensity(const Rgba& color) { return {color.r, color.g, color.b}; }

Material materialOf(const Visual& visual) {
  Material material;
  if (visual.finish.ambient) material.ambient = intensity(*visual.finish.ambient);
  material.specular = intensity(visual.finish.specular);
  material.shininess = visual.finish.shininess;
  material.emissive = intensity(visual.finish.emissive);
  material.opacity = std::clamp(visual.color.a, 0.0, 1.0);
  return material;
}

std::uint8_t byte(double value) { return static_cast<std::uint8_t>(std::lround(std::clamp(value, 0.0, 1.0) * 255)); }

/** What a <visual> shows. The URDF's material wins over the mesh file's. */
void addShapes(const Visual& visual, MeshCache& meshes, Body& body) {
  const Rgb color{byte(visual.color.r), byte(visual.color.g), byte(visual.color.b)};
  const Material material = materialOf(visual);
  const Pose& X_BS = visual.X_link_visual;
  if (!visual.texture.empty()) {
    const MeshPtr mesh = withPicture(*meshes.of(visual.geometry), meshes.picture(visual.texture));
    body.shapes.push_back({X_BS, shared(mesh), {255, 255, 255}, material});
    return;
  }
  if (visual.has_color) {
    MeshPtr mesh = meshes.of(visual.geometry);
    if (!mesh->colors.empty()) {
      auto plain = std::make_shared<TriangleMesh>(*mesh);
      plain->colors.clear();
      plain->pictures.clear();
      plain->picture_of.clear();
      mesh = plain;
    }
    body.shapes.push_back({X_BS, shared(mesh), color, material});
    return;
  }
  for (const MaterialMesh& part : meshes.partsOf(visual.geometry)) {
    Material own = isPlain(part.material) ? material : part.material;
    own.ambient_share = material.ambient_share;  // which files do not say
    own.ambient = material.ambient;
    body.shapes.push_back({X_BS, shared(part.mesh), color, own});
  }
}

}  // namespace

void addRobotBodies(const RobotModel& robot, const PackagePaths& packages, Scene& scene, const std::string& name) {
  MeshCache meshes(packages);
  for (const Link& link : robot.links) {
    if (link.visuals.empty()) continue;
    if (scene.findBody(scoped(name, link.name))) {
      throw ModelError("link '" + link.name + "': a solid of the scene has the same name (" + robot.source_name + ")");
    }
    Body body;
    body.name = scoped(name, link.name);
    for (const Visual& visual : link.visuals) {
      try {
        addShapes(visual, meshes, body);
      } catch (const ModelError& error) {
        throw ModelError("link '" + link.name + "': <visual>: " + error.what() + " (" + robot.source_name + ")");
      }
    }
    scene.bodies.push_back(std::move(body));
  }
  for (const LightTag& tag : robot.lights) {
    Light light = lightFromSdf(tag.sdf, robot.source_name + ": light of link '" + tag.link + "'");
    light.name = scoped(name, light.name);
    light.attached_to = scoped(name, tag.link);
    scene.lighting.lights.push_back(std::move(light));
  }
}

}  // namespace aras_visual_servo_sim
