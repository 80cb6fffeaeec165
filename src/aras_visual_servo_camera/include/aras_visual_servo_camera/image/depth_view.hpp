#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>

namespace aras_visual_servo_camera {

/** A depth image whose pixels somebody else owns: Z along the optical axis, as REP 118 has it. Row-major from the top
 *  left; row v starts at data + v * step_bytes; values are in the processor's order. */
struct DepthView {
  const std::uint8_t* data = nullptr;
  int width_px = 0;
  int height_px = 0;
  std::size_t step_bytes = 0;
  bool millimetres = false;  ///< uint16 [mm], else float [m]

  /** Z [m], NaN where there is none: in the image 0, negative, infinite or NaN. */
  double at(int u, int v) const {
    const std::uint8_t* row = data + static_cast<std::size_t>(v) * step_bytes;
    double z = 0.0;
    if (millimetres) {
      std::uint16_t value;
      std::memcpy(&value, row + 2 * static_cast<std::size_t>(u), sizeof(value));
      z = 1e-3 * value;
    } else {
      float value;
      std::memcpy(&value, row + 4 * static_cast<std::size_t>(u), sizeof(value));
      z = value;
    }
    return z > 0.0 && std::isfinite(z) ? z : std::numeric_limits<double>::quiet_NaN();
  }
};

}  // namespace aras_visual_servo_camera
