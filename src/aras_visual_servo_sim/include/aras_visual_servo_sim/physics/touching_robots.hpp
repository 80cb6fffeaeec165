#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "aras_visual_servo_sim/physics/multibody_world.hpp"

namespace aras_visual_servo_sim {

struct ContactPoint;

/** Steps the robots of a world together, so that they touch each other: links with collision shapes, and the obstacles
 *  of a robot's contacts. A robot whose contacts exclude neighbours touches no other one. A robot that touches no other
 *  one steps exactly as alone. Robots that touch each other are solved for together, with all points at which they
 * touch anything. Nothing is remembered from one step to the next. */
class TouchingRobots {
 public:
  /** @param robots  with one period; they outlive this object, and their contacts stay the same meanwhile. Contacts are
   *                 found in their order */
  explicit TouchingRobots(const std::vector<MultibodyWorld*>& robots);
  ~TouchingRobots();

  /** Advances all robots by one period. */
  void step();

 private:
  struct Crossing;

  bool touchesOther(std::size_t robot) const;
  void findPoints();
  void findBetween(std::size_t a, std::size_t b, const Eigen::AlignedBox3d& near);
  std::vector<ContactPoint> pointsOf(std::size_t robot, const std::vector<Crossing>& all) const;
  void solveIsland(std::size_t island);

  std::vector<MultibodyWorld*> robots_;
  std::vector<Eigen::AlignedBox3d> boxes_;
  std::vector<std::size_t> island_;  // of each robot: the first robot that it is connected to by points
  std::vector<Crossing> crossings_;
  std::vector<ContactPoint> points_;
};

}  // namespace aras_visual_servo_sim
