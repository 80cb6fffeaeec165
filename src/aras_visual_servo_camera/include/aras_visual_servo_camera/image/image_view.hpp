#pragma once

#include <cstddef>
#include <cstdint>
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

}  // namespace aras_visual_servo_camera
