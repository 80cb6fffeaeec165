#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace aras_visual_servo_sim {

/** Layout of one pixel; names are those of sensor_msgs/image_encodings. */
enum class Encoding { kRgb8, kBgr8, kMono8, kBayerRggb8, kBayerBggr8, kBayerGbrg8, kBayerGrbg8 };

/** @throws ParameterError unless name is that of one of them, as "rgb8" */
Encoding encodingFromName(const std::string& name);
const char* encodingName(Encoding encoding);
/** Bytes of one pixel: 3 or 1. */
int channelsOf(Encoding encoding);
/** Whether a pixel shows one of red, green and blue, by its place. */
inline bool isBayer(Encoding encoding) { return encoding >= Encoding::kBayerRggb8; }

/** Colour, 8 bits a channel, as displayed (no gamma is applied anywhere). */
struct Rgb {
  std::uint8_t r = 0;
  std::uint8_t g = 0;
  std::uint8_t b = 0;
  bool operator==(const Rgb& other) const { return r == other.r && g == other.g && b == other.b; }
};

/** Image of height x width pixels, row-major, top row first, no padding; channels interleaved as encoding says. */
template <typename Value>
struct ImageOf {
  int width = 0;
  int height = 0;
  Encoding encoding = Encoding::kRgb8;
  std::vector<Value> data;  ///< height * width * channels() values

  int channels() const { return channelsOf(encoding); }
  std::size_t stride() const { return static_cast<std::size_t>(width) * channels(); }
  const Value* pixel(int u, int v) const { return data.data() + v * stride() + u * channels(); }
  Value* pixel(int u, int v) { return data.data() + v * stride() + u * channels(); }
  /** Gives the image this size and encoding; memory is kept when it suffices, contents are undefined. */
  void resize(int new_width, int new_height, Encoding new_encoding) {
    width = new_width;
    height = new_height;
    encoding = new_encoding;
    data.resize(stride() * height);
  }
};

using Image = ImageOf<std::uint8_t>;  ///< as a camera delivers it: grey levels

/** As light falls on the sensor, before noise and rounding: 257 units are a grey level, so that 65535 are white. */
using FineImage = ImageOf<std::uint16_t>;

/** How many units of an image's values are a grey level. */
template <typename Value>
inline constexpr int kUnitsOf = sizeof(Value) == 1 ? 1 : 257;

}  // namespace aras_visual_servo_sim
