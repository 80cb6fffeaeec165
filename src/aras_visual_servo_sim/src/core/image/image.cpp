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

}  // namespace aras_visual_servo_sim
