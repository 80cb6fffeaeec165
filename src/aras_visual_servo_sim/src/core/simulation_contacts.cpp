// The solids of a Simulation's scene as things that can be touched.
#include "aras_visual_servo_sim/errors.hpp"
#include "aras_visual_servo_sim/simulation.hpp"

namespace aras_visual_servo_sim {
namespace {

/** Shape of an entry of `scene/solids`, which loadScene has accepted. */
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

}  // namespace

void Simulation::readContacts(const PackagePaths& packages) {
  ContactConfig& contacts = config_.world.contacts;
  if (!contacts.any()) return;
  const auto needMesh = [&](const Geometry& geometry) {
    if (geometry.type != Geometry::Type::kMesh || contacts.mesh_points.count(geometry.filename)) return;
    std::vector<Eigen::Vector3d>& points = contacts.mesh_points[geometry.filename];
    const MeshPtr mesh = loadMesh(packages.resolve(geometry.filename), Eigen::Vector3d::Ones(), packages);
    for (const Eigen::Vector3f& point : mesh->points) {
      points.push_back(point.cast<double>());
    }
  };
  for (const auto& solid : config_.scene["solids"]) {
    const auto name = solid["name"].as<std::string>();
    contacts.obstacles.push_back({name, solidGeometry(solid), modelPose(name), 0.0});
    needMesh(contacts.obstacles.back().geometry);
  }
  for (const Link& link : model_.links) {
    for (const Collision& collision : link.collisions) needMesh(collision.geometry);
  }
}

/** One period after the other: what moves by itself is placed, what is pushed is seen where it went. */
void Simulation::stepTouching(std::int64_t n) {
  for (std::int64_t k = 0; k < n; ++k) {
    moveModels();
    for (const Obstacle& solid : config_.world.contacts.obstacles) {
      if (motions_.count(solid.name)) world_->setObstaclePose(solid.name, modelPose(solid.name));
    }
    world_->step();
    showSolids();
  }
}

void Simulation::showSolids() {
  if (!config_.world.contacts.any()) return;
  for (const Obstacle& solid : config_.world.contacts.obstacles) {
    if (!motions_.count(solid.name)) placeOf(solid.name) = world_->obstaclePose(solid.name);
  }
}

void Simulation::touchModel(const std::string& model) {
  if (!config_.world.contacts.any()) return;
  for (const Obstacle& solid : config_.world.contacts.obstacles) {
    if (solid.name == model) world_->setObstaclePose(model, modelPose(model));
  }
}

}  // namespace aras_visual_servo_sim
