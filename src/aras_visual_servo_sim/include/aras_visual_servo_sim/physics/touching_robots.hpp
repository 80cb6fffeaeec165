#pragma once

#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "aras_visual_servo_sim/physics/multibody_world.hpp"

namespace aras_visual_servo_sim {

struct ContactPoint;

/** Two links of two robots that are held to each other as if they were one body. */
struct Weld {
  std::size_t a, b;    ///< robots
  int link_a, link_b;  ///< of theirs
  Pose X_AB;           ///< of link b in link a
};

/** Steps the robots of a world together, so that they touch each other: links with collision shapes, and the obstacles
 *  of a robot's contacts. A robot whose contacts exclude neighbours touches no other one. A robot that touches no other
 *  one steps exactly as alone. Robots that touch each other are solved for together, with all points at which they
 * touch anything. Links that are welded to each other do not touch each other. Nothing is remembered from one step to
 * the next. */
class TouchingRobots {
 public:
  /** @param robots  with one period; they outlive this object, and their contacts stay the same meanwhile. Contacts are
   *                 found in their order
   *  @param names  of the robots, for what their contacts() say; none: they say `another robot`
   *  @param welds  between two robots each, which takesWelds() allows */
  explicit TouchingRobots(const std::vector<MultibodyWorld*>& robots, std::vector<std::string> names = {},
                          std::vector<Weld> welds = {});
  ~TouchingRobots();

  /** Advances all robots by one period. */
  void step();

 private:
  struct Crossing;

  bool touchesOther(std::size_t robot) const;
  void findPoints();
  void findBetween(std::size_t a, std::size_t b, const Eigen::AlignedBox3d& near);
  void findWelds();
  bool moves(std::size_t robot, int link) const;
  bool welded(std::size_t a, int link_a, std::size_t b, int link_b) const;
  std::vector<ContactPoint> pointsOf(std::size_t robot, const std::vector<Crossing>& all) const;
  std::vector<std::string> othersOf(std::size_t robot, const std::vector<Crossing>& all) const;
  void solveIsland(std::size_t island);

  std::vector<MultibodyWorld*> robots_;
  std::vector<std::string> names_;
  std::vector<Weld> welds_;
  std::vector<Eigen::AlignedBox3d> boxes_;
  std::vector<std::size_t> island_;  // of each robot: the first robot that it is connected to by points
  std::vector<Crossing> crossings_;
  std::vector<ContactPoint> points_;
};

}  // namespace aras_visual_servo_sim
