#pragma once

#include <cstddef>

namespace aras_visual_servo_sim {

/** Allocations of this process since its start, by whatever way: operator new, malloc, Eigen's, Bullet's. */
std::size_t allocations();

/** Counts one more, of which somebody else has told. */
void countAllocation();

/** Allocations that an action makes. */
template <typename Action>
std::size_t allocationsOf(const Action& action) {
  const std::size_t before = allocations();
  action();
  return allocations() - before;
}

}  // namespace aras_visual_servo_sim
