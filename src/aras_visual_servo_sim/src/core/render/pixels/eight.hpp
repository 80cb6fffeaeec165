#pragma once

#include <cstdint>

namespace aras_visual_servo_sim {

/** Eight numbers, with the operators of one: each compiler makes of them what the processor has. */
using EightFloats = float __attribute__((vector_size(32)));
using EightInts = std::int32_t __attribute__((vector_size(32)));  ///< of a comparison: -1 where it holds, else 0

/** Eight numbers of an array, from any place in it. The structures are packed because clang ignores the alignment that
 * a typedef states once it is behind a reference: it would read from aligned places only. */
struct [[gnu::packed, gnu::may_alias]] EightFloatsOfArray {
  EightFloats values;
};
struct [[gnu::packed, gnu::may_alias]] EightIntsOfArray {
  EightInts values;
};
[[gnu::always_inline]] inline const EightFloatsOfArray& eightAt(const float* first) {
  return *reinterpret_cast<const EightFloatsOfArray*>(first);
}
[[gnu::always_inline]] inline EightFloatsOfArray& eightAt(float* first) {
  return *reinterpret_cast<EightFloatsOfArray*>(first);
}
[[gnu::always_inline]] inline EightIntsOfArray& eightAt(std::int32_t* first) {
  return *reinterpret_cast<EightIntsOfArray*>(first);
}

/** Their magnitudes. */
[[gnu::always_inline]] inline void dropSigns(EightFloats& x) {
  constexpr std::int32_t kAllButSign = 0x7fffffff;
  x = reinterpret_cast<EightFloats>(reinterpret_cast<EightInts>(x) & kAllButSign);
}

}  // namespace aras_visual_servo_sim
