#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace aras_visual_servo_sim {

/** Normal numbers of mean 0 and this deviation that belong to the pixels of a sensor, the same in every frame.
 *  @param seed  of the pattern  @return empty if the deviation is 0 */
std::vector<float> fixedPattern(double stddev, std::size_t count, std::uint64_t seed);

}  // namespace aras_visual_servo_sim
