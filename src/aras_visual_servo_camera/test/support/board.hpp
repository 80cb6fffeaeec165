#pragma once

#include <algorithm>
#include <random>

#include "coverage_image.hpp"

namespace aras_visual_servo_camera::testing {

constexpr double kFocal_px = 200.0;

/** A board full of rectangles, moved to the right. The same seed gives the same board. */
inline GreyImage board(int width, int height, int shift_px, unsigned seed = 3) {
  std::mt19937 random(seed);
  GreyImage image(width, height, 128);
  for (int k = 0; k < 300; ++k) {
    const int u0 = static_cast<int>(random() % static_cast<unsigned>(width)) + shift_px;
    const int v0 = static_cast<int>(random() % static_cast<unsigned>(height));
    const int w = static_cast<int>(random() % 30), h = static_cast<int>(random() % 30);
    const auto grey = static_cast<std::uint8_t>(random() % 256);
    for (int v = v0; v < std::min(v0 + h, height); ++v)
      for (int u = std::max(u0, 0); u < std::min(u0 + w, width); ++u) image.at(u, v) = grey;
  }
  return image;
}

/** Without a lens, kFocal_px, the principal point in the middle. */
inline CameraIntrinsics cameraOf(int width, int height) {
  return CameraIntrinsics(width, height, {kFocal_px, 0, 0.5 * width, 0, kFocal_px, 0.5 * height, 0, 0, 1}, "", {});
}

}  // namespace aras_visual_servo_camera::testing
