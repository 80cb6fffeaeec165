#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace aras_visual_servo_sim {

/** Layout of one pixel; names are those of sensor_msgs/image_encodings. */
enum class Encoding { kRgb8, kBgr8, kMono8 };

/** @throws ParameterError unless name is "rgb8", "bgr8" or "mono8" */
Encoding encodingFromName(const std::string& name);
const char* encodingName(Encoding encoding);
/** Bytes of one pixel: 3 or 1. */
int channelsOf(Encoding encoding);

/** Colour, 8 bits a channel, as displayed (no gamma is applied anywhere). */
struct Rgb {
  std::uint8_t r = 0;
  std::uint8_t g = 0;
  std::uint8_t b = 0;
  bool operator==(const Rgb& other) const { return r == other.r && g == other.g && b == other.b; }
};

/** Image of height x width pixels, row-major, top row first, no padding; channels interleaved as encoding says. */
struct Image {
  int width = 0;
  int height = 0;
  Encoding encoding = Encoding::kRgb8;
  std::vector<std::uint8_t> data;  ///< height * width * channels() bytes

  int channels() const { return channelsOf(encoding); }
  std::size_t stride() const { return static_cast<std::size_t>(width) * channels(); }
  const std::uint8_t* pixel(int u, int v) const { return data.data() + v * stride() + u * channels(); }
  std::uint8_t* pixel(int u, int v) { return data.data() + v * stride() + u * channels(); }
  /** Gives the image this size and encoding; memory is kept when it suffices, contents are undefined. */
  void resize(int width, int height, Encoding encoding);
};

/** Adds Gaussian noise to every byte, each channel by itself, rounded and clamped to [0, 255].
 *
 *  Counter based: what is added depends on (seed, frame_index, byte index) alone, so frame k is the same whatever was
 *  rendered before it.
 *  @param stddev  standard deviation before rounding, in grey levels, finite and >= 0; 0 adds the mean alone
 *  @param mean    in grey levels, finite
 *  @throws ParameterError if one is out of range */
void addGaussianNoise(Image& image, double stddev, std::uint64_t seed, std::uint64_t frame_index, double mean = 0.0);

}  // namespace aras_visual_servo_sim
