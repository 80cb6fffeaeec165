#pragma once

#include <Eigen/Core>
#include <array>
#include <memory>
#include <vector>

#include "aras_visual_servo_sim/config/types.hpp"
#include "aras_visual_servo_sim/robot/robot_model.hpp"

namespace aras_visual_servo_sim {

/** Where straight rays first meet shapes, as a laser scanner sees them. Boxes, cylinders, spheres and planes are met
 *  exactly, meshes at their triangles. Nothing is remembered from one call of cast() to the next. */
class RayCaster {
 public:
  using Triangle = std::array<Eigen::Vector3d, 3>;  ///< counter-clockwise seen from outside [m]

  /** What a ray met. */
  struct Hit {
    double distance_m;  ///< from where the ray begins; infinite: it met nothing
    int shape;          ///< as add() numbered it, -1: none
  };

  RayCaster();
  ~RayCaster();
  RayCaster(RayCaster&&) noexcept;

  /** Adds a box, cylinder or sphere to a body. @return its number, 0 for the first shape
   *  @throws ModelError unless its sizes are > 0 and it is one of the three */
  int add(int body, const Geometry& geometry, const Pose& X_BS);
  /** Adds the plane z = 0 of a pose, which is met from either side. @return its number */
  int addPlane(int body, const Pose& X_BS);
  /** Adds a mesh. @return its number @throws ModelError if there are no triangles, NotFiniteError */
  int addMesh(int body, const std::vector<Triangle>& triangles, const Pose& X_BS);

  /** Places all shapes of a body, which stand at the origin before. @throws NotFiniteError */
  void place(int body, const Pose& X_WB);

  /** The first surface on each ray at least `nearest_m` and at most `farthest_m` away.
   *  @param p_W           where the rays begin
   *  @param directions_W  unit vectors
   *  @param from_inside   whether surfaces are met from behind too
   *  @throws NotFiniteError, ParameterError unless 0 <= nearest_m <= farthest_m */
  std::vector<Hit> cast(const Eigen::Vector3d& p_W, const std::vector<Eigen::Vector3d>& directions_W, double nearest_m,
                        double farthest_m, bool from_inside) const;

 private:
  struct Shape;

  int append(Shape shape, int body, const Pose& X_BS);

  std::vector<std::unique_ptr<Shape>> shapes_;
};

}  // namespace aras_visual_servo_sim
