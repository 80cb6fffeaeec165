#include "aras_visual_servo_sim/image/image.hpp"

#include <cstring>

#include "aras_visual_servo_sim/config/errors.hpp"

namespace aras_visual_servo_sim {

namespace {

/** In the order of Encoding. */
constexpr const char* kNames[] = {"rgb8",        "bgr8",        "mono8",       "rgb16",      "mono16",
                                  "bayer_rggb8", "bayer_bggr8", "bayer_gbrg8", "bayer_grbg8"};

}  // namespace

Encoding encodingFromName(const std::string& name) {
  std::string known;
  int index = 0;
  for (const char* each : kNames) {
    if (name == each) return static_cast<Encoding>(index);
    known += (index++ == 0 ? "" : ", ") + std::string(each);
  }
  throw ParameterError("encoding: found '" + name + "', allowed " + known);
}

const char* encodingName(Encoding encoding) { return kNames[static_cast<int>(encoding)]; }

int channelsOf(Encoding encoding) {
  return encoding == Encoding::kRgb8 || encoding == Encoding::kBgr8 || encoding == Encoding::kRgb16 ? 3 : 1;
}

int bytesOf(Encoding encoding) { return isDeep(encoding) ? 2 * channelsOf(encoding) : channelsOf(encoding); }

Image upperBytes(const Image& image) {
  Image upper;
  upper.resize(image.width, image.height, isMono(image.encoding) ? Encoding::kMono8 : Encoding::kRgb8);
  for (std::size_t i = 0; i < upper.data.size(); ++i) {
    std::uint16_t value = 0;
    std::memcpy(&value, image.data.data() + 2 * i, sizeof(value));
    upper.data[i] = static_cast<std::uint8_t>(value >> 8);
  }
  return upper;
}

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
