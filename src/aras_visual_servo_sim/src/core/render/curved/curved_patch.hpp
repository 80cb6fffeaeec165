#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>

#include "aras_visual_servo_sim/config/types.hpp"
#include "aras_visual_servo_sim/scene/triangle_mesh.hpp"

namespace aras_visual_servo_sim {

/** One smooth part of a round body as one camera sees it: a sphere, the side of a cylinder or cone, or a disc.
 *
 *  A point of the surface on a ray d (in the camera's frame C) is d / n, with n the inverse of its depth along the ray.
 *  Put into the equation of the surface, which is quadratic, that gives
 *  n(d) = linear . d + root sqrt(d^T form d), and the ray misses where d^T form d < 0. Where a side ends, and where
 * what lies behind the camera is left out, is a bound linear in d and n. Of the front of a convex body n is concave in
 * d, so over a pixel it is least in a corner and below its tangent plane. */
struct CurvedPatch {
  enum class Part { kSphere, kCylinderSide, kConeSide, kDisc };
  /** Seen only where ray . d + nearness * n >= 0. */
  struct Bound {
    Eigen::Vector3d ray = Eigen::Vector3d::Zero();
    double nearness = 0.0;
  };
  /** Where a ray meets the surface, whatever its bounds. */
  struct Hit {
    double within;    ///< d^T form d: a miss if it is negative
    double nearness;  ///< n
  };

  Hit hit(const Eigen::Vector3d& ray) const;
  bool isWithinBounds(const Eigen::Vector3d& ray, double nearness) const {
    for (const Bound& bound : bounds) {
      if (bound.ray.dot(ray) + bound.nearness * nearness < 0.0) return false;
    }
    return nearness > 0.0;
  }
  /** Gradient of n with respect to the ray: the tangent plane of the surface, plane . d = n there. */
  Eigen::Vector3d plane(const Eigen::Vector3d& ray, const Hit& hit) const;
  /** Colour of the point on a ray, lit, its picture left out; 0 .. 255. Beyond the outline: of the nearest point of it.
   */
  Eigen::Vector3d color(const Eigen::Vector3d& ray) const;
  /** Texture coordinates of the point on a ray, in texels: s to the right, t down. @pre texture */
  Eigen::Vector2d texel(const Eigen::Vector3d& ray) const;

  Part part;
  Eigen::Matrix3d form = Eigen::Matrix3d::Zero();
  Eigen::Vector3d linear = Eigen::Vector3d::Zero();
  double root = 0.0;
  std::array<Bound, 2> bounds;

  Eigen::Matrix3d R_SC = Eigen::Matrix3d::Identity();  ///< S: frame of the shape
  Eigen::Vector3d p_SC = Eigen::Vector3d::Zero();      ///< the camera in S [m]
  RoundShape shape{};
  double side = 0.0;  ///< of a disc: -1 at the lower end of its body, 1 at the upper one
  Eigen::Vector3d rgb = Eigen::Vector3d::Zero();
  Eigen::Vector3d light_S = Eigen::Vector3d::Zero();  ///< where the light travels, unit
  const MeshPicture* texture = nullptr;

 private:
  Eigen::Vector3d point(const Eigen::Vector3d& ray) const;
};

/** The parts of a round body that face a camera. Calls add(patch) for each. A camera inside the body sees none.
 *  @param X_CS  pose of the body in the camera's frame */
template <typename Add>
void forEachPatch(const RoundShape& shape, const Pose& X_CS, const Add& add);

/** One part; nothing where it faces away from the camera. @param side  of discs: which end */
std::optional<CurvedPatch> patchOf(CurvedPatch::Part part, const RoundShape& shape, const Pose& X_CS,
                                   double side = 0.0);

template <typename Add>
void forEachPatch(const RoundShape& shape, const Pose& X_CS, const Add& add) {
  const auto tryPart = [&](CurvedPatch::Part part, double side) {
    if (auto patch = patchOf(part, shape, X_CS, side)) add(*patch);
  };
  if (shape.kind == RoundShape::Kind::kSphere) return tryPart(CurvedPatch::Part::kSphere, 0.0);
  const bool cone = shape.kind == RoundShape::Kind::kCone;
  tryPart(cone ? CurvedPatch::Part::kConeSide : CurvedPatch::Part::kCylinderSide, 0.0);
  tryPart(CurvedPatch::Part::kDisc, -1.0);
  if (!cone) tryPart(CurvedPatch::Part::kDisc, 1.0);
}

}  // namespace aras_visual_servo_sim
