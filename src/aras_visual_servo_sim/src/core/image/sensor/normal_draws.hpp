#pragma once

#include <cstdint>
#include <vector>

#include "aras_visual_servo_sim/config/splitmix.hpp"

namespace aras_visual_servo_sim {

/** Quantiles of the standard normal distribution at (k + 1/2) / 2^16: made once. */
const std::vector<float>& normalQuantiles();

/** Where the random words of a frame begin: word k of it is mix(stream + (k + 1) kGolden). */
inline std::uint64_t frameStream(std::uint64_t seed, std::uint64_t frame_index) {
  return splitmix::mix(splitmix::mix(seed + splitmix::kGolden) ^ (frame_index * splitmix::kGolden + 1));
}

inline std::uint64_t randomWord(std::uint64_t stream, std::uint64_t index) {
  return splitmix::mix(stream + (index + 1) * splitmix::kGolden);
}

}  // namespace aras_visual_servo_sim
