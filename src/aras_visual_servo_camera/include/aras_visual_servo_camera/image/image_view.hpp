#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <string>

namespace aras_visual_servo_camera {

/** Names of sensor_msgs; values of 16 bits are in the processor's order, 65535 is white. */
enum class PixelFormat {
  kMono8,
  kRgb8,
  kBgr8,
  kRgba8,
  kMono16,
  kRgb16,
  kBayerRggb8,
  kBayerBggr8,
  kBayerGbrg8,
  kBayerGrbg8
};

/** Whether a value has two bytes. */
constexpr bool isDeep(PixelFormat format) { return format == PixelFormat::kMono16 || format == PixelFormat::kRgb16; }
/** Whether a pixel holds one colour of three, by the place where it is. */
constexpr bool isBayer(PixelFormat format) { return format >= PixelFormat::kBayerRggb8; }
/** Values in one pixel. */
constexpr int channels(PixelFormat format) {
  if (format == PixelFormat::kMono8 || format == PixelFormat::kMono16 || isBayer(format)) return 1;
  return format == PixelFormat::kRgba8 ? 4 : 3;
}
/** Bytes in one pixel. */
constexpr int bytesOf(PixelFormat format) { return channels(format) * (isDeep(format) ? 2 : 1); }

/** An image whose pixels somebody else owns. Row-major from the top left; row v starts at data + v * step_bytes. */
struct ImageView {
  const std::uint8_t* data = nullptr;
  int width_px = 0;
  int height_px = 0;
  std::size_t step_bytes = 0;
  PixelFormat format = PixelFormat::kMono8;
};

/** @param encoding  a name of sensor_msgs/image_encodings.h  @throws ShapeError  one that PixelFormat does not have */
PixelFormat formatNamed(const std::string& encoding);

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
