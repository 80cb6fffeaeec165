#include "contact_shapes.hpp"

#include <algorithm>
#include <cmath>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "physics/bullet/to_bullet.hpp"

namespace aras_visual_servo_sim {

using Eigen::Vector3d;

namespace {

constexpr int kTurns = 3;
constexpr double kHullMargin = 1e-4;  // [m], by which Bullet lets hulls touch early: rounds their edges for its search

Vector3d fromBullet(const btVector3& v) { return Vector3d(v.x(), v.y(), v.z()); }

std::vector<Vector3d> boxCorners(const Vector3d& size) {
  std::vector<Vector3d> corners;
  for (int k = 0; k < 8; ++k) {
    corners.emplace_back((k & 1 ? 0.5 : -0.5) * size.x(), (k & 2 ? 0.5 : -0.5) * size.y(),
                         (k & 4 ? 0.5 : -0.5) * size.z());
  }
  return corners;
}

/** With its faces and edges known: only then Bullet cuts faces with each other, and finds all corners of a contact. */
std::unique_ptr<btCollisionShape> boxOf(const Vector3d& size) {
  auto box = std::make_unique<btBoxShape>(toBullet(Vector3d(0.5 * size)));
  box->initializePolyhedralFeatures();
  return box;
}

/** Tip and base of a cone, the base as a polygon of 32 corners. */
std::vector<Vector3d> coneCorners(double radius_m, double length_m) {
  constexpr int kCorners = 32;
  std::vector<Vector3d> corners{{0.0, 0.0, 0.5 * length_m}};
  for (int i = 0; i < kCorners; ++i) {
    const double angle = 2.0 * M_PI * i / kCorners;
    corners.push_back({radius_m * std::cos(angle), radius_m * std::sin(angle), -0.5 * length_m});
  }
  return corners;
}

std::unique_ptr<btCollisionShape> hullOf(const std::vector<Vector3d>& points) {
  auto hull = std::make_unique<btConvexHullShape>();
  for (const Vector3d& point : points) hull->addPoint(toBullet(point), false);
  hull->recalcLocalAabb();
  hull->optimizeConvexHull();
  hull->setMargin(kHullMargin);
  hull->initializePolyhedralFeatures();
  return hull;
}

constexpr double kFarther = 1.0 + 1e-9;  // than a corner is from its origin, whatever rounding does

/** Collects what Bullet finds between one pair. */
struct Collector : public btCollisionWorld::ContactResultCallback {
  std::vector<ContactPoint>* points = nullptr;
  const btCollisionObject* first = nullptr;
  ContactPoint contact;

  btScalar addSingleResult(btManifoldPoint& found, const btCollisionObjectWrapper* object, int, int,
                           const btCollisionObjectWrapper*, int, int) override {
    if (found.getDistance() >= 0.0) return 0.0;
    const bool swapped = object->getCollisionObject() != first;
    contact.normal = fromBullet(found.m_normalWorldOnB) * (swapped ? -1.0 : 1.0);
    contact.point = 0.5 * (fromBullet(found.getPositionWorldOnA()) + fromBullet(found.getPositionWorldOnB()));
    contact.depth_m = -found.getDistance();
    if (contact.normal.allFinite() && contact.point.allFinite()) points->push_back(contact);
    return 0.0;
  }
};

}  // namespace

ContactShapes::ContactShapes(const ContactConfig& config)
    : config_(config), dispatcher_(&bullet_config_), world_(&dispatcher_, &broadphase_, &bullet_config_) {
  world_.getDispatchInfo().m_enableSatConvex = true;
}

ContactShapes::~ContactShapes() = default;

void ContactShapes::add(int body, const Geometry& geometry, const Pose& X_BS) {
  const bool cone = geometry.type == Geometry::Type::kCone;
  const bool long_one = cone || geometry.type == Geometry::Type::kCylinder;
  const bool round = long_one || geometry.type == Geometry::Type::kSphere;
  if ((geometry.type == Geometry::Type::kBox && !(geometry.size_m.minCoeff() > 0.0)) ||
      (round && !(geometry.radius_m > 0.0)) || (long_one && !(geometry.length_m > 0.0))) {
    throw ModelError("collision shape: found a size that is not positive, must be > 0");
  }
  auto shape = std::make_unique<Shape>();
  shape->body = body;
  shape->X_BS = X_BS;
  shape->geometry = geometry;
  switch (geometry.type) {
    case Geometry::Type::kBox:
      shape->corners = boxCorners(geometry.size_m);
      shape->shape = boxOf(geometry.size_m);
      break;
    case Geometry::Type::kCylinder:
      shape->shape =
          std::make_unique<btCylinderShapeZ>(btVector3(geometry.radius_m, geometry.radius_m, 0.5 * geometry.length_m));
      break;
    case Geometry::Type::kCone:
      shape->corners = coneCorners(geometry.radius_m, geometry.length_m);
      shape->shape = hullOf(shape->corners);
      break;
    case Geometry::Type::kSphere:
      shape->shape = std::make_unique<btSphereShape>(geometry.radius_m);
      break;
    case Geometry::Type::kMesh: {
      const auto found = config_.mesh_points.find(geometry.filename);
      if (found == config_.mesh_points.end() || found->second.empty()) {
        throw ModelError("collision mesh '" + geometry.filename +
                         "': found no points, allowed a file that was loaded before");
      }
      for (const Vector3d& point : found->second) shape->corners.push_back(point.cwiseProduct(geometry.scale));
      shape->shape = hullOf(shape->corners);
      break;
    }
  }
  for (const Vector3d& corner : shape->corners) shape->reach_m = std::max(shape->reach_m, corner.norm());
  if (geometry.type == Geometry::Type::kSphere) shape->reach_m = geometry.radius_m;
  if (geometry.type == Geometry::Type::kCylinder)
    shape->reach_m = std::hypot(geometry.radius_m, 0.5 * geometry.length_m);
  shape->object = std::make_unique<btCollisionObject>();
  shape->object->setCollisionShape(shape->shape.get());
  shapes_.push_back(std::move(shape));
}

bool ContactShapes::has(int body) const {
  return std::any_of(shapes_.begin(), shapes_.end(), [&](const auto& shape) { return shape->body == body; });
}

void ContactShapes::watchPair(int a, int b, double friction) {
  for (std::size_t i = 0; i < shapes_.size(); ++i) {
    for (std::size_t j = 0; j < shapes_.size(); ++j) {
      if (shapes_[i]->body != a || shapes_[j]->body != b) continue;
      const bool known = std::any_of(pairs_.begin(), pairs_.end(), [&](const Pair& pair) {
        return (pair.a == i && pair.b == j) || (pair.a == j && pair.b == i);
      });
      if (!known) pairs_.push_back({i, j, friction});
    }
  }
}

void ContactShapes::watchGround(int body, double friction) {
  for (std::size_t i = 0; i < shapes_.size(); ++i) {
    if (shapes_[i]->body == body) grounded_.emplace_back(i, friction);
  }
}

void ContactShapes::place(int body, const Pose& X_WB) {
  for (auto& shape : shapes_) {
    if (shape->body != body) continue;
    shape->X_WS = X_WB * shape->X_BS;
    shape->object->setWorldTransform(toBullet(shape->X_WS));
  }
}

const std::vector<ContactPoint>& ContactShapes::find() {
  points_.clear();
  for (const auto& [i, friction] : grounded_) findOnGround(*shapes_[i], friction);
  for (const Pair& pair : pairs_) findBetween(*shapes_[pair.a], *shapes_[pair.b], pair.friction, points_);
  return points_;
}

void ContactShapes::addGroundPoint(const Shape& shape, double friction, const Vector3d& p_W) {
  const double depth = config_.ground->z_m - p_W.z();
  if (!(depth > 0.0)) return;
  // The force acts half way between the two surfaces, as Bullet has it between any two shapes.
  points_.push_back(
      {shape.body, ContactPoint::kGround, p_W + Vector3d(0.0, 0.0, 0.5 * depth), Vector3d::UnitZ(), depth, friction});
}

void ContactShapes::findOnGround(const Shape& shape, double friction) {
  const std::size_t first = points_.size();
  const Pose& X = shape.X_WS;
  if (shape.geometry.type == Geometry::Type::kSphere) {
    addGroundPoint(shape, friction, X.p - Vector3d(0.0, 0.0, shape.geometry.radius_m));
  } else if (shape.geometry.type == Geometry::Type::kCylinder) {
    // On each rim the lowest point and those a quarter of a turn from it.
    const Vector3d axis = X.q * Vector3d::UnitZ();
    Vector3d down = -Vector3d::UnitZ() + axis.z() * axis;
    down = down.norm() > 1e-9 ? down.normalized() : X.q * Vector3d::UnitX();
    const Vector3d side = axis.cross(down);
    for (const double end : {-0.5, 0.5}) {
      for (const Vector3d& out : {down, side, Vector3d(-down), Vector3d(-side)}) {
        addGroundPoint(shape, friction, X.p + end * shape.geometry.length_m * axis + shape.geometry.radius_m * out);
      }
    }
  } else if (X.p.z() - kFarther * shape.reach_m <= config_.ground->z_m) {
    for (const Vector3d& corner : shape.corners) addGroundPoint(shape, friction, X * corner);
  }
  thinOut(points_, first);
}

void ContactShapes::findBetween(const Shape& a, const Shape& b, double friction, std::vector<ContactPoint>& found) {
  btVector3 a_min, a_max, b_min, b_max;
  a.shape->getAabb(a.object->getWorldTransform(), a_min, a_max);
  b.shape->getAabb(b.object->getWorldTransform(), b_min, b_max);
  for (int k = 0; k < 3; ++k) {
    if (a_min[k] > b_max[k] || b_min[k] > a_max[k]) return;
  }
  const std::size_t first = found.size();
  Collector collector;
  collector.points = &found;
  collector.first = a.object.get();
  collector.contact.a = a.body;
  collector.contact.b = b.body;
  collector.contact.friction = friction;
  // Bullet turns a shape a little to and fro to find more points of one face than one. A ball has one.
  const bool ball = a.geometry.type == Geometry::Type::kSphere || b.geometry.type == Geometry::Type::kSphere;
  bullet_config_.setConvexConvexMultipointIterations(ball ? 0 : kTurns, ball ? 0 : kTurns);
  world_.contactPairTest(a.object.get(), b.object.get(), collector);
  keepCorners(found, first);
  thinOut(found, first);
}

Eigen::AlignedBox3d ContactShapes::boxAround(const std::vector<int>& bodies) const {
  Eigen::AlignedBox3d box;
  for (const auto& shape : shapes_) {
    if (std::find(bodies.begin(), bodies.end(), shape->body) == bodies.end()) continue;
    const Vector3d reach = Vector3d::Constant(kFarther * shape->reach_m);
    box.extend(shape->X_WS.p - reach).extend(shape->X_WS.p + reach);
  }
  return box;
}

std::vector<const ContactShapes::Shape*> ContactShapes::shapesNear(const std::vector<int>& bodies,
                                                                   const Eigen::AlignedBox3d& near) const {
  std::vector<const Shape*> shapes;
  for (const auto& shape : shapes_) {
    const double reach_m = kFarther * shape->reach_m;
    if (near.squaredExteriorDistance(shape->X_WS.p) > reach_m * reach_m) continue;
    if (std::find(bodies.begin(), bodies.end(), shape->body) != bodies.end()) shapes.push_back(shape.get());
  }
  return shapes;
}

void ContactShapes::findWith(const ContactShapes& others, const std::vector<int>& mine, const std::vector<int>& theirs,
                             const Eigen::AlignedBox3d& near, const std::function<double(int, int)>& friction,
                             std::vector<ContactPoint>& found) {
  const std::vector<const Shape*> there = others.shapesNear(theirs, near);
  if (there.empty()) return;
  for (const Shape* a : shapesNear(mine, near)) {
    for (const Shape* b : there) findBetween(*a, *b, friction(a->body, b->body), found);
  }
}

}  // namespace aras_visual_servo_sim
