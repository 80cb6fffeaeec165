#include "aras_visual_servo_sim/image/image.hpp"

#include "aras_visual_servo_sim/config/errors.hpp"

namespace aras_visual_servo_sim {

namespace {

/** In the order of Encoding. */
constexpr const char* kNames[] = {"rgb8", "bgr8", "mono8", "bayer_rggb8", "bayer_bggr8", "bayer_gbrg8", "bayer_grbg8"};

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

int channelsOf(Encoding encoding) { return encoding == Encoding::kRgb8 || encoding == Encoding::kBgr8 ? 3 : 1; }

}  // namespace aras_visual_servo_sim
