// What rays meet in a World.
#include "aras_visual_servo_sim/scene/mesh_loader.hpp"
#include "aras_visual_servo_sim/simulation/world.hpp"

namespace aras_visual_servo_sim {
namespace {

std::vector<RayCaster::Triangle> trianglesOf(const TriangleMesh& mesh) {
  std::vector<RayCaster::Triangle> triangles;
  for (const auto& corners : mesh.triangles) {
    triangles.emplace_back();
    for (std::size_t k = 0; k < 3; ++k) triangles.back()[k] = mesh.points[corners[k]].cast<double>();
  }
  return triangles;
}

}  // namespace

World::RayScene World::rayScene(bool visuals) const {
  RayScene made;
  int body = 0;
  const auto add = [&](int link, const Geometry& geometry, const Pose& X_BS) {
    try {
      if (geometry.type == Geometry::Type::kMesh) {
        const MeshPtr mesh = loadMesh(packages_.resolve(geometry.filename), geometry.scale, packages_);
        made.caster.addMesh(body, trianglesOf(*mesh), X_BS);
      } else {
        made.caster.add(body, geometry, X_BS);
      }
      made.links.push_back(link);
    } catch (const ArasError&) {  // nothing can be met: no size, no triangles
    }
  };
  for (const auto& robot : robots_) {
    for (const Link& link : robot->model().links) {
      if (visuals) {
        for (const Visual& visual : link.visuals) add(body, visual.geometry, visual.X_link_visual);
      } else {
        for (const Collision& shape : link.collisions) add(body, shape.geometry, shape.X_link_collision);
      }
      ++body;
    }
  }
  for (const auto& [name, solid] : models_.set().solids) {
    for (const Collision& shape : solid.shapes) add(-1, shape.geometry, shape.X_link_collision);
    made.solids.push_back(name);
    ++body;
  }
  if (const std::optional<GroundPlane>& ground = config_.world.contacts.ground) {
    made.caster.addPlane(body, Pose{{0.0, 0.0, ground->z_m}, Eigen::Quaterniond::Identity()});
    made.links.push_back(-1);
  }
  return made;
}

std::vector<World::RayHit> World::castRays(const Eigen::Vector3d& p_W, const std::vector<Eigen::Vector3d>& directions_W,
                                           double nearest_m, double farthest_m, bool visuals) {
  std::unique_ptr<RayScene>& scene = rays_[visuals ? 1 : 0];
  if (!scene) scene = std::make_unique<RayScene>(rayScene(visuals));
  int body = 0;
  for (const auto& robot : robots_) {
    for (int link = 0; link < static_cast<int>(robot->model().links.size()); ++link) {
      scene->caster.place(body++, robot->body().linkPose(link));
    }
  }
  for (const std::string& solid : scene->solids) scene->caster.place(body++, models_.pose(solid));
  std::vector<RayHit> hits;
  for (const RayCaster::Hit& hit : scene->caster.cast(p_W, directions_W, nearest_m, farthest_m, !visuals)) {
    hits.push_back({hit.distance_m, hit.shape < 0 ? -1 : scene->links[static_cast<std::size_t>(hit.shape)]});
  }
  return hits;
}

}  // namespace aras_visual_servo_sim
