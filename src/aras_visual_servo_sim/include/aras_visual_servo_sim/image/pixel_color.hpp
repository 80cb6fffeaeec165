#pragma once

#include <array>
#include <cstdint>

#include "aras_visual_servo_sim/image/image.hpp"

namespace aras_visual_servo_sim {

/** Nearest byte of a colour's part, 0 .. 255. */
inline std::uint8_t byteOf(double part) { return static_cast<std::uint8_t>(part + 0.5); }

/** Grey of a colour: ITU-R BT.601 luma, as OpenCV's cvtColor. */
inline std::uint8_t greyOf(double r, double g, double b) { return byteOf(0.299 * r + 0.587 * g + 0.114 * b); }

/** Bytes of one pixel of this colour; mono8 uses the first only. */
inline std::array<std::uint8_t, 3> pixelOf(const Rgb& color, Encoding encoding) {
  switch (encoding) {
    case Encoding::kRgb8:
      return {color.r, color.g, color.b};
    case Encoding::kBgr8:
      return {color.b, color.g, color.r};
    default: {
      const std::uint8_t grey = greyOf(color.r, color.g, color.b);
      return {grey, grey, grey};
    }
  }
}

}  // namespace aras_visual_servo_sim
