#pragma once

#include <memory>
#include <vector>

#include "aras_visual_servo_sim/physics/multibody_world.hpp"

namespace aras_visual_servo_sim {

/** Worlds that are stepped together, so that their robots touch each other: links with collision shapes, and what moves
 *  freely in the contacts of a world. A world that is configured without contacts touches nothing. A world that touches
 *  no other one steps exactly as alone; those that do are solved for together, with the points at which each of them
 *  touches anything. Nothing is remembered from one step to the next. */
class WorldGroup {
 public:
  /** @param worlds  of one period, outlive this object and are not given other contacts meanwhile; the order is that in
   *                 which contacts are found @throws ParameterError unless the periods are the same */
  explicit WorldGroup(const std::vector<MultibodyWorld*>& worlds);
  ~WorldGroup();

  /** One period. */
  void step();

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace aras_visual_servo_sim
