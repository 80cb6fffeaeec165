#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <string>

namespace aras_visual_servo_camera {

/** Names of sensor_msgs. Each format of 16 bits a value is 16 more than that of 8 bits. */
enum class PixelFormat {
  kMono8,
  kRgb8,
  kBgr8,
  kRgba8,
  kBgra8,
  kBayerRggb8,
  kBayerBggr8,
  kBayerGbrg8,
  kBayerGrbg8,
  kYuv422,      ///< U Y V Y for two pixels
  kYuv422Yuy2,  ///< Y U Y V
  kMono16 = 16,
  kRgb16,
  kBgr16,
  kRgba16,
  kBgra16,
  kBayerRggb16,
  kBayerBggr16,
  kBayerGbrg16,
  kBayerGrbg16
};

/** Whether a value has two bytes. */
constexpr bool isDeep(PixelFormat format) { return format >= PixelFormat::kMono16; }
/** The format of 8 bits a value with the same channels. */
constexpr PixelFormat shallow(PixelFormat format) { return static_cast<PixelFormat>(static_cast<int>(format) % 16); }
/** Whether a pixel holds one colour of three, by the place where it is. */
constexpr bool isBayer(PixelFormat format) {
  return shallow(format) >= PixelFormat::kBayerRggb8 && shallow(format) <= PixelFormat::kBayerGrbg8;
}
/** Whether two pixels share their colour. */
constexpr bool isYuv(PixelFormat format) { return shallow(format) >= PixelFormat::kYuv422; }
/** Values in one pixel. */
constexpr int channels(PixelFormat format) {
  if (isYuv(format)) return 2;
  if (shallow(format) == PixelFormat::kMono8 || isBayer(format)) return 1;
  return shallow(format) >= PixelFormat::kRgba8 ? 4 : 3;
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
  bool upper_byte_first = false;  ///< of values of 16 bits; else they are in the processor's order
  int white = 65535;              ///< value of 16 bits that becomes 255
};

/** @param encoding  a name of sensor_msgs/image_encodings.h; one of OpenCV, such as 8UC3, is grey, bgr or bgra
 *  @throws ShapeError  one that PixelFormat does not have */
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
