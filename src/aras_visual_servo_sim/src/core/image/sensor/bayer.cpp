#include "aras_visual_servo_sim/image/sensor/bayer.hpp"

namespace aras_visual_servo_sim {

int colorAt(Encoding encoding, int x, int v) {
  const int u = x % 2, down = v % 2;
  switch (encoding) {
    case Encoding::kRgb8:
    case Encoding::kRgb16:
      return x % 3;
    case Encoding::kBgr8:
      return 2 - x % 3;
    case Encoding::kBayerRggb8:
      return u + down;
    case Encoding::kBayerBggr8:
      return 2 - u - down;
    case Encoding::kBayerGbrg8:
      return 1 + u - down;
    case Encoding::kBayerGrbg8:
      return 1 - u + down;
    default:
      return 1;
  }
}

void throughBayerFilter(const FineImage& rgb, Encoding encoding, FineImage& mosaic) {
  mosaic.resize(rgb.width, rgb.height, encoding);
  for (int v = 0; v < rgb.height; ++v) {
    const int colors[] = {colorAt(encoding, 0, v), colorAt(encoding, 1, v)};
    const std::uint16_t* from = rgb.pixel(0, v);
    std::uint16_t* to = mosaic.pixel(0, v);
    for (int u = 0; u < rgb.width; ++u) to[u] = from[3 * u + colors[u % 2]];
  }
}

}  // namespace aras_visual_servo_sim
