#pragma once

#include "coverage_image.hpp"

namespace aras_visual_servo_camera::testing {

/** Sets the pixels of a box, which has to lie in the image, to one grey. */
inline void fill(GreyImage* image, int u0, int v0, int width, int height, std::uint8_t grey) {
  for (int v = v0; v < v0 + height; ++v)
    for (int u = u0; u < u0 + width; ++u) image->at(u, v) = grey;
}

}  // namespace aras_visual_servo_camera::testing
