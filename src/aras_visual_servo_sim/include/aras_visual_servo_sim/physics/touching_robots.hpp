#pragma once

#include <memory>
#include <vector>

#include "aras_visual_servo_sim/physics/multibody_world.hpp"

namespace aras_visual_servo_sim {

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
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace aras_visual_servo_sim
