// What the links of a URDF look like: as bodies of a robot, or as one solid.
#include <algorithm>
#include <cmath>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "aras_visual_servo_sim/robot/urdf_loader.hpp"
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
  material.unlit = visual.finish.unlit;
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
    const MeshPtr mesh =
        withPicture(*meshes.of(visual.geometry), meshes.picture(visual.texture), visual.texture_transform);
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
    own.unlit = own.unlit || material.unlit;
    body.shapes.push_back({X_BS, shared(part.mesh), color, own});
  }
}

/** X_RL of every link in the root's frame. @throws ModelError for a joint that moves */
std::vector<Pose> linkPoses(const RobotModel& robot, const std::string& name) {
  std::vector<Pose> poses;
  for (const Link& link : robot.links) {  // parents first
    if (link.parent_joint < 0) {
      poses.emplace_back();
      continue;
    }
    const Joint& joint = robot.joints[static_cast<std::size_t>(link.parent_joint)];
    if (joint.type != JointType::kFixed) {
      throw ModelError("model '" + name + "': joint '" + joint.name + "' of its URDF moves, allowed fixed joints");
    }
    poses.push_back(poses[static_cast<std::size_t>(joint.parent_link)] * joint.X_PJ);
  }
  return poses;
}

RobotModel loadUrdf(const std::string& name, const std::string& urdf, const PackagePaths& packages) {
  const bool is_document = urdf.find('<') != std::string::npos;
  return is_document ? loadRobotModel(urdf, "model '" + name + "'") : loadRobotModelFile(packages.resolve(urdf));
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

std::vector<Collision> collisionsFromUrdf(const std::string& name, const std::string& urdf,
                                          const PackagePaths& packages) {
  const RobotModel robot = loadUrdf(name, urdf, packages);
  const std::vector<Pose> X_RL = linkPoses(robot, name);
  std::vector<Collision> collisions;
  for (std::size_t link = 0; link < robot.links.size(); ++link) {
    for (Collision collision : robot.links[link].collisions) {
      collision.X_link_collision = X_RL[link] * collision.X_link_collision;
      collisions.push_back(std::move(collision));
    }
  }
  return collisions;
}

Body bodyFromUrdf(const std::string& name, const std::string& urdf, const PackagePaths& packages,
                  std::vector<Light>* lights) {
  const RobotModel robot = loadUrdf(name, urdf, packages);
  const std::vector<Pose> X_RL = linkPoses(robot, name);
  Scene parts;
  addRobotBodies(robot, packages, parts);
  Body body;
  body.name = name;
  for (const Body& part : parts.bodies) {
    const Pose& X_BL = X_RL[static_cast<std::size_t>(robot.linkIndex(part.name))];
    for (Shape shape : part.shapes) {
      shape.X_BS = X_BL * shape.X_BS;
      body.shapes.push_back(std::move(shape));
    }
  }
  for (Light light : parts.lighting.lights) {
    if (!lights) break;
    const Pose& X_BL = X_RL[static_cast<std::size_t>(robot.linkIndex(light.attached_to))];
    light.name = name + "::" + light.name;
    light.attached_to = name;
    light.position_A = X_BL * light.position_A;
    light.direction_A = X_BL.q * light.direction_A;
    lights->push_back(std::move(light));
  }
  const bool touchable =
      std::any_of(robot.links.begin(), robot.links.end(), [](const Link& link) { return !link.collisions.empty(); });
  if (body.shapes.empty() && !touchable) {
    throw ModelError("model '" + name + "': no link of its URDF has a <visual> or a <collision>");
  }
  return body;
}

}  // namespace aras_visual_servo_sim
