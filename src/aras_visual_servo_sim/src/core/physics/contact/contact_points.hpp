#pragma once

#include <Eigen/Core>
#include <vector>

namespace aras_visual_servo_sim {

/** One point where two bodies overlap. */
struct ContactPoint {
  int a = 0, b = 0;               ///< bodies, as given to ContactShapes::add; or one of those below
  Eigen::Vector3d point, normal;  ///< in the world; the normal points from b to a
  double depth_m = 0.0;           ///< > 0
  double friction = 0.0;
  bool bonded = false;                            ///< held together here in all directions, see Weld; no contact
  Eigen::Vector3d gap = Eigen::Vector3d::Zero();  ///< of a bonded one, in the world: from the point on a to that on b

  static constexpr int kGround = -1;     ///< the plane
  static constexpr int kElsewhere = -2;  ///< a body of another robot, see TouchingRobots
};

/** Of the points from `first` on, all of one contact, leaves those that are corners of their outline in the plane
 *  across the normal: two faces cut with each other have points on their edges, and some twice, by rounding. */
void keepCorners(std::vector<ContactPoint>& points, std::size_t first);

/** Of more than eight points from `first` on leaves four: the deepest, then those farthest from the ones kept. */
void thinOut(std::vector<ContactPoint>& points, std::size_t first);

}  // namespace aras_visual_servo_sim
