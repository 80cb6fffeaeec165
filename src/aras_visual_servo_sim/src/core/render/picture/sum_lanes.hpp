#pragma once

#include <cstdint>
#include <cstring>

namespace aras_visual_servo_sim {

/** How the running sums of a texture level are computed with: one channel as numbers, three as vectors of four, whose
 *  last entry is of no meaning. */
template <int channels>
struct SumLanes;

template <>
struct SumLanes<1> {
  using Value = float;
  using Sums = std::int32_t;
  static Sums load(const std::int32_t* sums) { return *sums; }
  static Value real(Sums sums) { return static_cast<float>(sums); }
  static float at(const Value& value, int) { return value; }
};

template <>
struct SumLanes<3> {
  using Value __attribute__((vector_size(16))) = float;
  using Sums __attribute__((vector_size(16))) = std::int32_t;
  static Sums load(const std::int32_t* sums) {
    Sums loaded;
    std::memcpy(&loaded, sums, sizeof loaded);
    return loaded;
  }
  static Value real(const Sums& sums) { return __builtin_convertvector(sums, Value); }
  static float at(const Value& value, int channel) { return value[channel]; }
};

}  // namespace aras_visual_servo_sim
