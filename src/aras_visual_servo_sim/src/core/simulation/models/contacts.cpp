#include "aras_visual_servo_sim/simulation/models/contacts.hpp"

#include <algorithm>
#include <utility>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "aras_visual_servo_sim/physics/contact_config.hpp"
#include "aras_visual_servo_sim/scene/mesh_loader.hpp"

namespace aras_visual_servo_sim {
namespace {

const char* const kEverything = "all";
const char* const kRobot = "robot";

void addObstacles(const std::string& name, const ModelSet& set, ContactConfig& contacts) {
  const TouchableSolid& solid = set.solids.at(name);
  const Pose& start = set.starts.at(name);
  for (const Collision& shape : solid.shapes) {
    contacts.obstacles.push_back(
        {name, shape.geometry, Pose{start.p, start.q.normalized()}, solid.mass_kg, shape.X_link_collision});
  }
}

bool sameShape(const Geometry& a, const Geometry& b) {
  return a.type == b.type && a.size_m == b.size_m && a.radius_m == b.radius_m && a.length_m == b.length_m &&
         a.filename == b.filename && a.scale == b.scale;
}

bool sameObstacle(const Obstacle& a, const Obstacle& b) {
  return a.name == b.name && a.mass_kg == b.mass_kg && sameShape(a.geometry, b.geometry) && a.X_OG.p == b.X_OG.p &&
         a.X_OG.q.coeffs() == b.X_OG.q.coeffs();
}

/** Whether the same bodies touch, wherever they are; of two configurations that differ in nothing else. */
bool sameBodies(const ContactConfig& a, const ContactConfig& b) {
  return a.pairs == b.pairs && a.free_bodies == b.free_bodies &&
         std::equal(a.obstacles.begin(), a.obstacles.end(), b.obstacles.begin(), b.obstacles.end(), sameObstacle);
}

}  // namespace

Contacts::Contacts(const ContactConfig& config, const RobotModel& robot, const PackagePaths& packages)
    : config_(config), robot_(robot), packages_(packages) {}

void Contacts::begin(const ModelSet& built, const std::vector<SolidEntry>& solids) {
  for (const SolidEntry& solid : solids) solids_.push_back(solid.name);
  built_starts_ = built.starts;
  for (const std::string& solid : solids_) check(solid, built);
  change(built);
}

bool Contacts::has(const std::string& model) const {
  return any() && std::any_of(present_.obstacles.begin(), present_.obstacles.end(),
                              [&](const Obstacle& solid) { return solid.name == model; });
}

bool Contacts::isThere(const std::string& name, const ModelSet& set) const {
  return name == kEverything || name == kRobot || set.starts.count(name) > 0 ||
         std::any_of(robot_.links.begin(), robot_.links.end(), [&](const Link& link) { return link.name == name; });
}

void Contacts::check(const std::string& name, const ModelSet& set) const {
  const TouchableSolid& solid = set.solids.at(name);
  for (const std::string& other : solid.touches) {
    if (isThere(other, set)) continue;
    std::string known = std::string(kEverything) + ", " + kRobot;
    for (const auto& start : set.starts) known += ", " + start.first;
    for (const Link& link : robot_.links) known += ", " + link.name;
    throw ParameterError("solid '" + name + "': touches: found " + other + ", allowed " + known);
  }
  if (solid.mass_kg > 0.0 && solid.touches.empty() && !config_.any()) {
    throw ParameterError("solid '" + name +
                         "': mass_kg: found it with nothing to touch, must have touches, or sim/contacts");
  }
}

/** The contacts of the configuration, with the solids that there are. */
ContactConfig Contacts::among(const ModelSet& set) {
  ContactConfig contacts = config_;
  const auto add = [&](const std::string& name) {
    addObstacles(name, set, contacts);
    // `all` and `robot` have to stand first in a pair: what cannot touch is then skipped instead of refused.
    for (const std::string& other : set.solids.at(name).touches) {
      if (isThere(other, set)) contacts.pairs.emplace_back(other, name);
    }
  };
  for (const std::string& name : solids_) {
    if (set.starts.count(name) > 0 && set.spawned.count(name) == 0) {
      add(name);
    } else {
      contacts.free_bodies.erase(name);
    }
  }
  for (std::size_t k = 0; k < set.body_links.size(); ++k) {
    if (set.body_links[k].isSolid() && set.spawned.count(set.scene.bodies[k].name) > 0) add(set.scene.bodies[k].name);
  }
  // Leave out pairs with models that were deleted. Names that never existed were refused when the world was built.
  const auto isGone = [&](const std::string& name) { return built_starts_.count(name) > 0 && !isThere(name, set); };
  contacts.pairs.erase(std::remove_if(contacts.pairs.begin(), contacts.pairs.end(),
                                      [&](const auto& pair) { return isGone(pair.first) || isGone(pair.second); }),
                       contacts.pairs.end());
  if (contacts.any()) addMeshPoints(contacts);
  return contacts;
}

void Contacts::addMeshPoints(ContactConfig& contacts) {
  const auto add = [&](const Geometry& geometry) {
    if (geometry.type != Geometry::Type::kMesh) return;
    auto known = mesh_points_.find(geometry.filename);
    if (known == mesh_points_.end()) {
      const MeshPtr mesh = loadMesh(packages_.resolve(geometry.filename), Eigen::Vector3d::Ones(), packages_);
      known = mesh_points_.emplace(geometry.filename, std::vector<Eigen::Vector3d>()).first;
      for (const Eigen::Vector3f& point : mesh->points) known->second.push_back(point.cast<double>());
      if (!config_.pushes() && isHollow(known->second, mesh->triangles)) hollow_meshes_.insert(geometry.filename);
    }
    contacts.mesh_points.insert(*known);
    if (hollow_meshes_.count(geometry.filename) > 0) contacts.hollow_meshes.insert(geometry.filename);
  };
  for (const Obstacle& obstacle : contacts.obstacles) add(obstacle.geometry);
  for (const Link& link : robot_.links) {
    for (const Collision& collision : link.collisions) add(collision.geometry);
  }
}

void Contacts::change(const ModelSet& set, MultibodyWorld& world) {
  ContactConfig next = among(set);
  // What is only seen comes and goes without the convex hulls being made anew.
  if ((next.any() || any()) && !sameBodies(next, present_)) world.setContacts(next);
  present_ = std::move(next);
}

void Contacts::setGround(const std::optional<GroundPlane>& ground, MultibodyWorld& world) {
  config_.ground = present_.ground = ground;
  world.setContacts(present_);
}

void Contacts::place(const std::string& model, const Models& models, MultibodyWorld& world) const {
  if (has(model)) world.setObstaclePose(model, models.pose(model));
}

void Contacts::beforePeriod(std::int64_t period_ns, Models& models, MultibodyWorld& world) const {
  models.move(world.ticks() * period_ns);
  for (const Obstacle& solid : present_.obstacles) {
    if (models.hasMotion(solid.name)) world.setObstaclePose(solid.name, models.pose(solid.name));
  }
}

void Contacts::afterPeriod(Models& models, const MultibodyWorld& world) const {
  for (const Obstacle& solid : present_.obstacles) {
    const bool pushed = solid.mass_kg > 0.0 || present_.free_bodies.count(solid.name) > 0;
    if (pushed && !models.hasMotion(solid.name)) models.place(solid.name, world.obstaclePose(solid.name));
  }
}

}  // namespace aras_visual_servo_sim
