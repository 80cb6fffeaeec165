#include "aras_visual_servo_sim/physics/ray_caster.hpp"

#include <BulletCollision/CollisionShapes/btBvhTriangleMeshShape.h>
#include <BulletCollision/CollisionShapes/btTriangleMesh.h>
#include <BulletCollision/NarrowPhaseCollision/btRaycastCallback.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "physics/bullet/to_bullet.hpp"

namespace aras_visual_servo_sim {

using Eigen::Vector3d;

namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();

/** A ray in the axes of a shape, and the part of it that counts. */
struct Ray {
  Vector3d p, d;
  double nearest, farthest;
  bool from_inside;
};

/** The stretch of a ray that is inside something convex; empty if begin > end. */
struct Stretch {
  double begin = -kNever, end = kNever;

  void cut(double from, double to) {
    begin = std::max(begin, from);
    end = std::min(end, to);
  }
  void clear() { cut(kNever, -kNever); }
};

/** Cuts a stretch to where |p + t d| <= half, along one axis. */
void cutSlab(double p, double d, double half, Stretch& stretch) {
  if (d != 0.0) {
    const double a = (-half - p) / d;
    const double b = (half - p) / d;
    stretch.cut(std::min(a, b), std::max(a, b));
  } else if (std::abs(p) > half) {
    stretch.clear();
  }
}

/** Cuts a stretch to where the first `axes` coordinates are within a radius of the origin. */
void cutRound(const Ray& ray, int axes, double radius, Stretch& stretch) {
  const double a = ray.d.head(axes).squaredNorm();
  const double b = ray.p.head(axes).dot(ray.d.head(axes));
  const double c = ray.p.head(axes).squaredNorm() - radius * radius;
  if (a == 0.0) {
    if (c > 0.0) stretch.clear();
    return;
  }
  const double discriminant = b * b - a * c;
  if (discriminant < 0.0) return stretch.clear();
  const double root = std::sqrt(discriminant);
  // The sum of two numbers of one sign keeps its digits; the other solution follows from the product of both.
  const double q = -(b + std::copysign(root, b));
  const double first = q / a;
  const double second = q != 0.0 ? c / q : first;
  stretch.cut(std::min(first, second), std::max(first, second));
}

/** Where a ray meets the surface around a stretch; infinite: nowhere. */
double met(const Ray& ray, const Stretch& stretch) {
  if (stretch.begin > stretch.end) return kNever;
  double at = stretch.begin;
  if (at < ray.nearest) at = ray.from_inside ? stretch.end : kNever;
  return at >= ray.nearest && at <= ray.farthest ? at : kNever;
}

/** Keeps the nearest triangle, as Bullet's tree of triangles hands them out. */
struct NearestTriangle : public btTriangleRaycastCallback {
  using btTriangleRaycastCallback::btTriangleRaycastCallback;
  bool found = false;

  btScalar reportHit(const btVector3&, btScalar fraction, int, int) override {
    found = true;
    m_hitFraction = fraction;
    return fraction;
  }
};

void checkFinite(bool finite, const char* what) {
  if (!finite) throw NotFiniteError(std::string("rays: found ") + what + " that is not finite, must be finite");
}

}  // namespace

struct RayCaster::Shape {
  enum class Kind { kSolid, kPlane, kMesh };

  int body = 0;
  Kind kind = Kind::kSolid;
  Geometry geometry;  // of solids
  Pose X_BS, X_WS;
  double reach_m = kNever;  // from the shape's origin to its farthest point
  std::unique_ptr<btTriangleMesh> triangles;
  std::unique_ptr<btBvhTriangleMeshShape> tree;

  double meet(const Ray& ray) const {
    Stretch inside;
    switch (kind) {
      case Kind::kPlane: {
        const double at = -ray.p.z() / ray.d.z();
        return at >= ray.nearest && at <= ray.farthest ? at : kNever;
      }
      case Kind::kMesh:
        return meetMesh(ray);
      case Kind::kSolid:
        break;
    }
    if (geometry.type == Geometry::Type::kBox) {
      for (int k = 0; k < 3; ++k) cutSlab(ray.p[k], ray.d[k], 0.5 * geometry.size_m[k], inside);
    } else if (geometry.type == Geometry::Type::kCylinder) {
      cutRound(ray, 2, geometry.radius_m, inside);
      cutSlab(ray.p.z(), ray.d.z(), 0.5 * geometry.length_m, inside);
    } else {
      cutRound(ray, 3, geometry.radius_m, inside);
    }
    return met(ray, inside);
  }

  double meetMesh(const Ray& ray) const {
    // Beyond the mesh there is nothing to be met: a shorter ray is a more exact one.
    const double farthest = std::min(ray.farthest, ray.p.norm() + reach_m);
    if (farthest <= ray.nearest) return kNever;
    const btVector3 from = toBullet(Vector3d(ray.p + ray.nearest * ray.d));
    const btVector3 to = toBullet(Vector3d(ray.p + farthest * ray.d));
    NearestTriangle nearest(
        from, to, ray.from_inside ? btTriangleRaycastCallback::kF_None : btTriangleRaycastCallback::kF_FilterBackfaces);
    tree->performRaycast(&nearest, from, to);
    return nearest.found ? ray.nearest + nearest.m_hitFraction * (farthest - ray.nearest) : kNever;
  }
};

RayCaster::RayCaster() = default;
RayCaster::~RayCaster() = default;
RayCaster::RayCaster(RayCaster&&) noexcept = default;

/** Adds a shape of a kind to a body. @return its number */
int RayCaster::append(Shape shape, int body, const Pose& X_BS) {
  shape.body = body;
  shape.X_BS = shape.X_WS = X_BS;
  shapes_.push_back(std::make_unique<Shape>(std::move(shape)));
  return static_cast<int>(shapes_.size()) - 1;
}

int RayCaster::add(int body, const Geometry& geometry, const Pose& X_BS) {
  Shape shape;
  shape.geometry = geometry;
  switch (geometry.type) {
    case Geometry::Type::kBox:
      shape.reach_m = geometry.size_m.minCoeff() > 0.0 ? 0.5 * geometry.size_m.norm() : 0.0;
      break;
    case Geometry::Type::kCylinder:
      shape.reach_m = std::min(geometry.radius_m, geometry.length_m) > 0.0
                          ? std::hypot(geometry.radius_m, 0.5 * geometry.length_m)
                          : 0.0;
      break;
    case Geometry::Type::kSphere:
      shape.reach_m = geometry.radius_m;
      break;
    default:
      throw ModelError("rays: found another shape, allowed are a box, a cylinder or a sphere");
  }
  if (!(shape.reach_m > 0.0) || !std::isfinite(shape.reach_m)) {
    throw ModelError("rays: found a shape whose size is not positive, must be > 0");
  }
  return append(std::move(shape), body, X_BS);
}

int RayCaster::addPlane(int body, const Pose& X_BS) {
  Shape shape;
  shape.kind = Shape::Kind::kPlane;
  return append(std::move(shape), body, X_BS);
}

int RayCaster::addMesh(int body, const std::vector<Triangle>& triangles, const Pose& X_BS) {
  if (triangles.empty()) throw ModelError("rays: found a mesh of no triangles, must have one or more");
  Shape shape;
  shape.kind = Shape::Kind::kMesh;
  shape.reach_m = 0.0;
  shape.triangles = std::make_unique<btTriangleMesh>();
  for (const Triangle& corners : triangles) {
    for (const Vector3d& corner : corners) {
      checkFinite(corner.allFinite(), "a corner of a mesh");
      shape.reach_m = std::max(shape.reach_m, corner.norm());
    }
    shape.triangles->addTriangle(toBullet(corners[0]), toBullet(corners[1]), toBullet(corners[2]));
  }
  shape.tree = std::make_unique<btBvhTriangleMeshShape>(shape.triangles.get(), true);
  return append(std::move(shape), body, X_BS);
}

void RayCaster::place(int body, const Pose& X_WB) {
  checkFinite(X_WB.p.allFinite() && X_WB.q.coeffs().allFinite(), "a pose");
  for (auto& shape : shapes_) {
    if (shape->body == body) shape->X_WS = X_WB * shape->X_BS;
  }
}

std::vector<RayCaster::Hit> RayCaster::cast(const Vector3d& p_W, const std::vector<Vector3d>& directions_W,
                                            double nearest_m, double farthest_m, bool from_inside) const {
  checkFinite(p_W.allFinite(), "a place");
  for (const Vector3d& direction : directions_W) checkFinite(direction.allFinite(), "a direction");
  if (!(nearest_m >= 0.0 && farthest_m >= nearest_m)) {
    throw ParameterError("rays: found a range from " + std::to_string(nearest_m) + " to " + std::to_string(farthest_m) +
                         " m, allowed is 0 <= from <= to");
  }
  std::vector<Hit> hits(directions_W.size(), Hit{kNever, -1});
  for (std::size_t i = 0; i < shapes_.size(); ++i) {
    const Shape& shape = *shapes_[i];
    const Eigen::Matrix3d R_SW = shape.X_WS.q.toRotationMatrix().transpose();
    const Vector3d p_S = R_SW * (p_W - shape.X_WS.p);
    if (p_S.norm() > farthest_m + shape.reach_m) continue;
    for (std::size_t k = 0; k < directions_W.size(); ++k) {
      const Ray ray{p_S, R_SW * directions_W[k], nearest_m, std::min(farthest_m, hits[k].distance_m), from_inside};
      // The shape is within a ball: most rays pass it by.
      if (p_S.cross(ray.d).norm() > shape.reach_m) continue;
      const double at = shape.meet(ray);
      if (at < hits[k].distance_m) hits[k] = {at, static_cast<int>(i)};
    }
  }
  return hits;
}

}  // namespace aras_visual_servo_sim
