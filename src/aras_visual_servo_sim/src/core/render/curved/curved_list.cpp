#include "curved_list.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "render/view/shading.hpp"

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

using Part = CurvedPatch::Part;

/** Surface (p - shift)^T diag(scale) (p - shift) = level in the shape's frame, its inside where it is less. */
struct Quadric {
  Eigen::Vector3d scale, shift;
  double level;
};

Quadric quadricOf(Part part, const RoundShape& shape) {
  const double radius = shape.radius_m, half = 0.5 * shape.length_m;
  switch (part) {
    case Part::kSphere:
      return {Eigen::Vector3d::Ones(), Eigen::Vector3d::Zero(), radius * radius};
    case Part::kCylinderSide:
      return {{1.0, 1.0, 0.0}, Eigen::Vector3d::Zero(), radius * radius};
    default: {
      const double slope = radius / shape.length_m;
      return {{1.0, 1.0, -slope * slope}, {0.0, 0.0, half}, 0.0};
    }
  }
}

/** One part of a round body; nothing where it faces away from the camera. A camera inside the body sees none.
 *  @param X_CS  pose of the body in the camera's frame @param side  of discs: which end */
std::optional<CurvedPatch> patchOf(Part part, const RoundShape& shape, const Pose& X_CS, double side) {
  const Pose X_SC = X_CS.inverse();
  CurvedPatch patch;
  patch.part = part;
  patch.shape = shape;
  patch.side = side;
  patch.R_SC = X_SC.q.toRotationMatrix();
  patch.p_SC = X_SC.p;
  const double half = 0.5 * shape.length_m;
  const Eigen::Vector3d& o = patch.p_SC;
  const Eigen::Vector3d axis_C = patch.R_SC.row(2).transpose();
  if (part == Part::kDisc) {
    const double height = o.z() - side * half;  // of the camera over the disc's plane
    if (!(height * side > 0.0)) return std::nullopt;
    patch.linear = -axis_C / height;
    // (x, y) n of the point on a ray, linear in the ray.
    const Eigen::Matrix<double, 2, 3> across = o.head<2>() * patch.linear.transpose() + patch.R_SC.topRows<2>();
    patch.form =
        shape.radius_m * shape.radius_m * patch.linear * patch.linear.transpose() - across.transpose() * across;
    return patch;
  }
  const Quadric quadric = quadricOf(part, shape);
  const Eigen::Vector3d from = o - quadric.shift, scaled = quadric.scale.cwiseProduct(from);
  const double outside = scaled.dot(from) - quadric.level;
  const bool above = part == Part::kConeSide && from.z() > 0.0;  // over the tip, inside the mirrored cone
  const double least = 1e-12 * (from.squaredNorm() + shape.radius_m * shape.radius_m);  // on the surface, to rounding
  if (!(outside > least) && !(above && outside < -least)) return std::nullopt;
  // outside n^2 + 2 (scaled . d) n + d^T diag(scale) d = 0, d in the shape's frame.
  const Eigen::Vector3d half_linear = patch.R_SC.transpose() * scaled;
  patch.linear = -half_linear / outside;
  patch.root = 1.0 / outside;
  patch.form = half_linear * half_linear.transpose() -
               outside * (patch.R_SC.transpose() * quadric.scale.asDiagonal() * patch.R_SC);
  if (part != Part::kSphere) {  // -half n <= z n <= half n, with z n = o.z n + axis . d
    patch.bounds[0] = {axis_C, o.z() + half};
    patch.bounds[1] = {-axis_C, half - o.z()};
  }
  return patch;
}

}  // namespace

CurvedPatch::Hit CurvedPatch::hit(const Eigen::Vector3d& ray) const {
  const double within = ray.dot(form * ray);
  return {within, linear.dot(ray) + root * std::sqrt(std::max(within, 0.0))};
}

Eigen::Vector3d CurvedPatch::plane(const Eigen::Vector3d& ray, const Hit& hit) const {
  if (root == 0.0 || !(hit.within > 0.0)) return linear;
  return linear + root / std::sqrt(hit.within) * (form * ray);
}

/** In the shape's frame. */
Eigen::Vector3d CurvedPatch::point(const Eigen::Vector3d& ray) const {
  const double nearness = hit(ray).nearness;
  return nearness > 0.0 ? Eigen::Vector3d(p_SC + R_SC * ray / nearness) : Eigen::Vector3d::Zero();
}

Eigen::Vector3d CurvedPatch::color(const Eigen::Vector3d& ray) const {
  const Eigen::Vector3d p = point(ray);
  Eigen::Vector3d normal = Eigen::Vector3d(0.0, 0.0, side);
  if (part != Part::kDisc) {
    const Quadric quadric = quadricOf(part, shape);
    normal = quadric.scale.cwiseProduct(p - quadric.shift).normalized();
  }
  return litShare(normal, light_S, p - p_SC) * rgb;
}

Eigen::Vector2d CurvedPatch::texel(const Eigen::Vector3d& ray) const {
  const Eigen::Vector3d p = point(ray);
  const Eigen::Vector2d size(texture->texture->width(), texture->texture->height());
  const double turn = std::atan2(p.y(), p.x()) / (2.0 * M_PI), full_turn = turn < 0.0 ? turn + 1.0 : turn;
  switch (part) {
    case Part::kSphere:
      return size.cwiseProduct(
          Eigen::Vector2d(full_turn, std::acos(std::clamp(p.z() / shape.radius_m, -1.0, 1.0)) / M_PI));
    case Part::kDisc:
      return size.cwiseProduct(
          Eigen::Vector2d(0.5 + side * 0.5 * p.x() / shape.radius_m, 0.5 - 0.5 * p.y() / shape.radius_m));
    default:
      return size.cwiseProduct(Eigen::Vector2d(0.25 - full_turn, p.z() / shape.length_m + 0.5));
  }
}

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
  if (std::all_of(volume_->begin(), volume_->end(), [&](const ViewCell& cell) {
        return cell.excludes(X_CS.p, radius) || cell.depth(X_CS.p) - radius > camera_->farM();
      })) {
    return;
  }
  const std::vector<RayCone>& cones = camera_->blockCones();
  near_tiles_.clear();
  for (std::size_t tile = 0; tile < cones.size(); ++tile) {
    if (meetsBall(cones[tile], X_CS.p, radius)) near_tiles_.push_back(static_cast<std::uint32_t>(tile));
  }
  const auto add = [&](Part part, double side = 0.0) {
    std::optional<CurvedPatch> found = patchOf(part, round, X_CS, side);
    if (!found) return;
    CurvedPatch& patch = *found;
    const TriangleMesh& mesh = *shape.mesh;
    patch.rgb = Eigen::Vector3d(shape.color.r, shape.color.g, shape.color.b);
    patch.light_S = patch.R_SC * light_C;
    patch.texture = mesh.pictures.empty() ? nullptr : &mesh.pictures.front();
    const auto entry = static_cast<std::uint32_t>(entries_.size());
    for (const std::uint32_t tile : near_tiles_) {
      if (meetsSurface(cones[tile], patch.form)) touched_.emplace_back(tile, entry);
    }
    entries_.push_back({patch, body});
  };
  if (sphere) return add(Part::kSphere);
  const bool cone = round.kind == RoundShape::Kind::kCone;
  add(cone ? Part::kConeSide : Part::kCylinderSide);
  add(Part::kDisc, -1.0);
  if (!cone) add(Part::kDisc, 1.0);
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
