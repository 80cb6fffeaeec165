// The solids of a Simulation's scene as things that can be touched.
#include <algorithm>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "aras_visual_servo_sim/scene/mesh_loader.hpp"
#include "aras_visual_servo_sim/scene/scene_loader.hpp"
#include "aras_visual_servo_sim/simulation/simulation.hpp"

namespace aras_visual_servo_sim {
namespace {

/** Shape of an entry of `scene/solids`, which loadScene has accepted; not of a URDF. */
Geometry solidGeometry(const YAML::Node& solid) {
  Geometry geometry;
  if (solid["box_m"]) {
    for (int k = 0; k < 3; ++k) geometry.size_m[k] = solid["box_m"][k].as<double>();
  } else if (solid["cylinder_m"]) {
    geometry.type = Geometry::Type::kCylinder;
    geometry.radius_m = solid["cylinder_m"][0].as<double>();
    geometry.length_m = solid["cylinder_m"][1].as<double>();
  } else if (solid["sphere_m"]) {
    geometry.type = Geometry::Type::kSphere;
    geometry.radius_m = solid["sphere_m"].as<double>();
  } else {
    geometry.type = Geometry::Type::kMesh;
    geometry.filename = solid["mesh"].as<std::string>();
    for (int k = 0; k < 3 && solid["scale"]; ++k) geometry.scale[k] = solid["scale"][k].as<double>();
  }
  return geometry;
}

std::vector<std::string> touchedBy(const YAML::Node& solid) {
  const YAML::Node touches = solid["touches"];
  if (!touches.IsDefined()) return {};
  return touches.IsScalar() ? std::vector<std::string>{touches.Scalar()} : touches.as<std::vector<std::string>>();
}

void addObstacles(const YAML::Node& solid, const Pose& X_WO, const PackagePaths& packages, ContactConfig& contacts) {
  const auto name = solid["name"].as<std::string>();
  const Pose X{X_WO.p, X_WO.q.normalized()};
  if (solid["urdf"]) {
    for (const Collision& each : collisionsFromUrdf(name, solid["urdf"].as<std::string>(), packages)) {
      contacts.obstacles.push_back({name, each.geometry, X, 0.0, each.X_link_collision});
    }
  } else {
    const double mass_kg = solid["mass_kg"] ? solid["mass_kg"].as<double>() : 0.0;
    contacts.obstacles.push_back({name, solidGeometry(solid), X, mass_kg, Pose{}});
  }
}

}  // namespace

bool Simulation::isThere(const std::string& name, const ModelSet& set) const {
  return name == "all" || name == "robot" || set.starts.count(name) > 0 ||
         std::any_of(model_.links.begin(), model_.links.end(), [&](const Link& link) { return link.name == name; });
}

/** @throws ParameterError for a solid that touches what is not there, or has mass and nothing to touch */
void Simulation::checkTouched(const YAML::Node& solid, const ModelSet& set) const {
  const auto name = solid["name"].as<std::string>();
  for (const std::string& other : touchedBy(solid)) {
    if (isThere(other, set)) continue;
    std::string known = "all, robot";
    for (const auto& start : set.starts) known += ", " + start.first;
    for (const Link& link : model_.links) known += ", " + link.name;
    throw ParameterError("solid '" + name + "': touches: found " + other + ", allowed " + known);
  }
  if (solid["mass_kg"] && touchedBy(solid).empty() && !config_.world.contacts.any()) {
    throw ParameterError("solid '" + name +
                         "': mass_kg: found it with nothing to touch, must have touches, or sim/contacts");
  }
}

/** The contacts of the configuration, with the solids that there are. */
ContactConfig Simulation::touchable(const ModelSet& set) const {
  ContactConfig contacts = config_.world.contacts;
  const auto add = [&](const YAML::Node& solid, const Pose& X_WO) {
    addObstacles(solid, X_WO, packages_, contacts);
    // `all` and `robot` stand first: what cannot touch is passed over then, not refused.
    for (const std::string& other : touchedBy(solid)) {
      if (isThere(other, set)) contacts.pairs.emplace_back(other, solid["name"].as<std::string>());
    }
  };
  for (const auto& solid : config_.scene["solids"]) {
    const auto name = solid["name"].as<std::string>();
    if (set.starts.count(name) > 0 && set.spawned.count(name) == 0) {
      add(solid, set.starts.at(name));
    } else {
      contacts.free_bodies.erase(name);
    }
  }
  for (std::size_t k = 0; k < set.body_links.size(); ++k) {
    const auto spawned = set.spawned.find(set.scene.bodies[k].name);
    if (set.body_links[k] >= 0 || spawned == set.spawned.end()) continue;
    add(YAML::Load(spawned->second), set.starts.at(spawned->first));
  }
  // Pairs with what was deleted since. Names nobody ever had are refused when the world is built.
  const auto isGone = [&](const std::string& name) {
    return models_.starts.count(name) + (built_ ? built_->starts.count(name) : 0) > 0 && !isThere(name, set);
  };
  contacts.pairs.erase(std::remove_if(contacts.pairs.begin(), contacts.pairs.end(),
                                      [&](const auto& pair) { return isGone(pair.first) || isGone(pair.second); }),
                       contacts.pairs.end());
  if (!contacts.any()) return contacts;
  const auto needMesh = [&](const Geometry& geometry) {
    if (geometry.type != Geometry::Type::kMesh || contacts.mesh_points.count(geometry.filename)) return;
    std::vector<Eigen::Vector3d>& points = contacts.mesh_points[geometry.filename];
    const MeshPtr mesh = loadMesh(packages_.resolve(geometry.filename), Eigen::Vector3d::Ones(), packages_);
    for (const Eigen::Vector3f& point : mesh->points) {
      points.push_back(point.cast<double>());
    }
  };
  for (const Obstacle& obstacle : contacts.obstacles) needMesh(obstacle.geometry);
  for (const Link& link : model_.links) {
    for (const Collision& collision : link.collisions) needMesh(collision.geometry);
  }
  return contacts;
}

/** Lets the solids of a set of models touch from now on. @throws as MultibodyWorld::setContacts; nothing changes then
 */
void Simulation::touch(const ModelSet& set) {
  ContactConfig next = touchable(set);
  if (next.any() || touching_.any()) world_->setContacts(next);
  touching_ = std::move(next);
}

/** One period after the other: what moves by itself is placed, what is pushed is seen where it went. */
void Simulation::stepTouching(std::int64_t n) {
  for (std::int64_t k = 0; k < n; ++k) {
    moveModels();
    for (const Obstacle& solid : touching_.obstacles) {
      if (motions_.count(solid.name)) world_->setObstaclePose(solid.name, modelPose(solid.name));
    }
    world_->step();
    showSolids();
  }
}

void Simulation::showSolids() {
  if (!touching_.any()) return;
  for (const Obstacle& solid : touching_.obstacles) {
    if (solid.mass_kg > 0.0 || touching_.free_bodies.count(solid.name) > 0) {
      if (!motions_.count(solid.name)) placeOf(solid.name) = world_->obstaclePose(solid.name);
    }
  }
}

bool Simulation::touches(const std::string& model) const {
  return touching_.any() && std::any_of(touching_.obstacles.begin(), touching_.obstacles.end(),
                                        [&](const Obstacle& solid) { return solid.name == model; });
}

void Simulation::touchModel(const std::string& model) {
  if (touches(model)) world_->setObstaclePose(model, modelPose(model));
}

}  // namespace aras_visual_servo_sim
