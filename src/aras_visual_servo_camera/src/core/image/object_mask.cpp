#include "aras_visual_servo_camera/image/object_mask.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace aras_visual_servo_camera {

void ObjectMask::render(std::uint8_t* out) const {
  std::memset(out, 0, static_cast<std::size_t>(width_px) * height_px);
  for (const Span& s : spans)
    std::memset(out + static_cast<std::size_t>(s.v) * width_px + s.u_begin, 255, s.u_end - s.u_begin);
  for (const EdgePixel& e : edge)
    out[static_cast<std::size_t>(e.v) * width_px + e.u] =
        static_cast<std::uint8_t>(std::lround(255.0 * std::clamp(e.weight, 0.0, 1.0)));
}

}  // namespace aras_visual_servo_camera
