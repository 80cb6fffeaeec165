#pragma once

#include <array>
#include <cstdint>

#include "aras_visual_servo_sim/image/image.hpp"

namespace aras_visual_servo_sim {

/** Grey of a colour: ITU-R BT.601 luma, as OpenCV's cvtColor. */
inline double luma(double r, double g, double b) { return 0.299 * r + 0.587 * g + 0.114 * b; }

/** Nearest value of an image to a colour's part, 0 .. 255. */
template <typename Value>
Value valueOf(double part) {
  return static_cast<Value>(part * kUnitsOf<Value> + 0.5);
}

/** Values of one pixel of this colour; mono8 uses the first only. @param r, g, b  0 .. 255 */
template <typename Value>
std::array<Value, 3> pixelOf(double r, double g, double b, Encoding encoding) {
  switch (encoding) {
    case Encoding::kRgb8:
      return {valueOf<Value>(r), valueOf<Value>(g), valueOf<Value>(b)};
    case Encoding::kBgr8:
      return {valueOf<Value>(b), valueOf<Value>(g), valueOf<Value>(r)};
    default: {
      const Value grey = valueOf<Value>(luma(r, g, b));
      return {grey, grey, grey};
    }
  }
}

template <typename Value = std::uint8_t>
std::array<Value, 3> pixelOf(const Rgb& color, Encoding encoding) {
  return pixelOf<Value>(color.r, color.g, color.b, encoding);
}

}  // namespace aras_visual_servo_sim
