#include "curved_list.hpp"

#include <algorithm>
#include <cmath>

namespace aras_visual_servo_sim {
namespace {

/** Whether a cone of rays may meet a ball about a point. */
bool meetsBall(const RayCone& cone, const Eigen::Vector3d& center, double radius) {
  const double distance = center.norm();
  if (distance <= radius) return true;
  const double sine = radius / distance, cosine = std::sqrt(1.0 - sine * sine);
  // cos(a + b) of the two half angles, neither of them beyond 90 degrees.
  return cone.axis.dot(center) >= distance * (cone.cosine * cosine - cone.sine * sine);
}

/** Whether some ray of a cone may meet the unbounded surface of a patch: an upper bound of d^T form d over it. */
bool meetsSurface(const RayCone& cone, const Eigen::Matrix3d& form) {
  const Eigen::Vector3d turned = form * cone.axis;
  const double off = cone.sine / cone.cosine;  // rays are axis + o with |o| up to this
  return cone.axis.dot(turned) + off * (2.0 * turned.norm() + off * form.norm()) >= 0.0;
}

}  // namespace

void CurvedList::begin(const CameraModel& camera, const ViewVolume& volume) {
  camera_ = &camera;
  volume_ = &volume;
  entries_.clear();
  touched_.clear();
  starts_.clear();
}

bool CurvedList::addBodies(const Scene& scene, const Pose& X_CW) {
  const Eigen::Vector3d light_C = X_CW.q * scene.light_direction_W.normalized();
  for (const Body& body : scene.bodies) {
    if (!body.visible) continue;
    for (const Shape& shape : body.shapes) {
      if (!shape.mesh->round) continue;
      addShape(shape, X_CW * body.X_WB * shape.X_BS, light_C, static_cast<std::size_t>(&body - scene.bodies.data()));
    }
  }
  if (!touched_.empty()) sort();
  return !touched_.empty();
}

void CurvedList::addShape(const Shape& shape, const Pose& X_CS, const Eigen::Vector3d& light_C, std::size_t body) {
  const RoundShape& round = *shape.mesh->round;
  const bool sphere = round.kind == RoundShape::Kind::kSphere;
  const double radius = sphere ? round.radius_m : std::hypot(round.radius_m, 0.5 * round.length_m);
  const auto cells = volume_->cells();
  if (std::all_of(cells.begin(), cells.end(), [&](const ViewCell& cell) {
        return cell.excludes(X_CS.p, radius) || cell.depth(X_CS.p) - radius > camera_->farM();
      })) {
    return;
  }
  const std::vector<RayCone>& cones = camera_->blockCones();
  near_tiles_.clear();
  for (std::size_t tile = 0; tile < cones.size(); ++tile) {
    if (meetsBall(cones[tile], X_CS.p, radius)) near_tiles_.push_back(static_cast<std::uint32_t>(tile));
  }
  forEachPatch(round, X_CS, [&](CurvedPatch& patch) {
    const TriangleMesh& mesh = *shape.mesh;
    patch.rgb = Eigen::Vector3d(shape.color.r, shape.color.g, shape.color.b);
    patch.light_S = patch.R_SC * light_C;
    patch.texture = mesh.pictures.empty() ? nullptr : &mesh.pictures.front();
    const auto entry = static_cast<std::uint32_t>(entries_.size());
    for (const std::uint32_t tile : near_tiles_) {
      if (meetsSurface(cones[tile], patch.form)) touched_.emplace_back(tile, entry);
    }
    entries_.push_back({patch, body});
  });
}

/** Counts, running sums, entries. */
void CurvedList::sort() {
  starts_.assign(camera_->blockCones().size() + 1, 0);
  for (const auto& [tile, entry] : touched_) ++starts_[tile + 1];
  for (std::size_t k = 1; k < starts_.size(); ++k) starts_[k] += starts_[k - 1];
  sorted_.resize(touched_.size());
  next_.assign(starts_.begin(), starts_.end() - 1);
  for (const auto& [tile, entry] : touched_) sorted_[next_[tile]++] = entry;
}

}  // namespace aras_visual_servo_sim
