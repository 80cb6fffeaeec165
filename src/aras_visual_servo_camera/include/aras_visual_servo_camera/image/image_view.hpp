#pragma once

#include <cstddef>
#include <cstdint>

namespace aras_visual_servo_camera {

enum class PixelFormat { kMono8, kRgb8, kBgr8, kRgba8 };

/** Bytes in one pixel. */
constexpr int channels(PixelFormat format) {
  return format == PixelFormat::kMono8 ? 1 : (format == PixelFormat::kRgba8 ? 4 : 3);
}

/** An image whose pixels somebody else owns. Row-major from the top left; row v starts at data + v * step_bytes. */
struct ImageView {
  const std::uint8_t* data = nullptr;
  int width_px = 0;
  int height_px = 0;
  std::size_t step_bytes = 0;
  PixelFormat format = PixelFormat::kMono8;
};

}  // namespace aras_visual_servo_camera
