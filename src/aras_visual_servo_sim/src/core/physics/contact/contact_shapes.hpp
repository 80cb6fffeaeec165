#pragma once

#include <BulletCollision/btBulletCollisionCommon.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "aras_visual_servo_sim/physics/contact_config.hpp"
#include "contact_points.hpp"

namespace aras_visual_servo_sim {

/** Convex shapes on bodies and where they overlap. Bullet's narrow phase between shapes, with nothing remembered from
 *  one call to the next; exact points against the plane. */
class ContactShapes {
 public:
  explicit ContactShapes(const ContactConfig& config);
  ~ContactShapes();
  ContactShapes(const ContactShapes&) = delete;
  ContactShapes& operator=(const ContactShapes&) = delete;

  /** Adds a shape to a body. @throws ModelError if it is a mesh whose points are not in the configuration */
  void add(int body, const Geometry& geometry, const Pose& X_BS);
  bool has(int body) const;

  /** The pairs and bodies to look at from now on. */
  void watchPair(int a, int b, double friction);
  void watchGround(int body, double friction);

  /** Places all shapes of a body. */
  void place(int body, const Pose& X_WB);

  /** Overlaps now, in an order that depends on nothing but the calls above. */
  const std::vector<ContactPoint>& find();

  /** The box around some bodies where they are now; empty if they have no shapes. */
  Eigen::AlignedBox3d boxAround(const std::vector<int>& bodies) const;
  /** Adds the overlaps now of some bodies, a in the points, with bodies of others, b in the points.
   *  @param near      both boxes around these bodies have this in common
   *  @param friction  of a body here and one there */
  void findWith(const ContactShapes& others, const std::vector<int>& mine, const std::vector<int>& theirs,
                const Eigen::AlignedBox3d& near, const std::function<double(int, int)>& friction,
                std::vector<ContactPoint>& found);

 private:
  struct Shape {
    int body;
    Pose X_BS, X_WS;
    Geometry geometry;
    std::vector<Eigen::Vector3d> corners;  // of boxes and meshes
    double reach_m = 0.0;                  // of its farthest point from the shape's origin
    std::unique_ptr<btCollisionShape> shape;
    std::unique_ptr<btCollisionObject> object;
  };
  struct Pair {
    std::size_t a, b;  // of shapes_
    double friction;
  };

  void findOnGround(const Shape& shape, double friction);
  void addGroundPoint(const Shape& shape, double friction, const Eigen::Vector3d& p_W);
  void findBetween(const Shape& a, const Shape& b, double friction, std::vector<ContactPoint>& found);
  std::vector<const Shape*> shapesNear(const std::vector<int>& bodies, const Eigen::AlignedBox3d& near) const;

  ContactConfig config_;
  std::vector<std::unique_ptr<Shape>> shapes_;
  std::vector<Pair> pairs_;
  std::vector<std::pair<std::size_t, double>> grounded_;  // of shapes_, friction
  std::vector<ContactPoint> points_;
  btDefaultCollisionConfiguration bullet_config_;
  btCollisionDispatcher dispatcher_;
  btDbvtBroadphase broadphase_;
  btCollisionWorld world_;
};

}  // namespace aras_visual_servo_sim
