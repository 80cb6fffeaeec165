#include "aras_visual_servo_sim/image/image.hpp"

#include "aras_visual_servo_sim/config/errors.hpp"

namespace aras_visual_servo_sim {

Encoding encodingFromName(const std::string& name) {
  if (name == "rgb8") return Encoding::kRgb8;
  if (name == "bgr8") return Encoding::kBgr8;
  if (name == "mono8") return Encoding::kMono8;
  throw ParameterError("encoding: found '" + name + "', allowed rgb8, bgr8, mono8");
}

const char* encodingName(Encoding encoding) {
  switch (encoding) {
    case Encoding::kRgb8:
      return "rgb8";
    case Encoding::kBgr8:
      return "bgr8";
    default:
      return "mono8";
  }
}

int channelsOf(Encoding encoding) { return encoding == Encoding::kMono8 ? 1 : 3; }

}  // namespace aras_visual_servo_sim
