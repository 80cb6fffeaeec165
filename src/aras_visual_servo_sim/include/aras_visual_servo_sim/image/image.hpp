#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace aras_visual_servo_sim {

/** Layout of one pixel; names are those of sensor_msgs/image_encodings. */
enum class Encoding { kRgb8, kBgr8, kMono8, kRgb16, kMono16, kBayerRggb8, kBayerBggr8, kBayerGbrg8, kBayerGrbg8 };

/** @throws ParameterError unless name is that of one of them, as "rgb8" */
Encoding encodingFromName(const std::string& name);
const char* encodingName(Encoding encoding);
/** Values of one pixel: 3 or 1. */
int channelsOf(Encoding encoding);
/** Bytes of one pixel: a value has two of 16 bits, in the processor's order. */
int bytesOf(Encoding encoding);
/** Whether a value has 16 bits, 65535 for white, instead of 8. */
inline bool isDeep(Encoding encoding) { return encoding == Encoding::kRgb16 || encoding == Encoding::kMono16; }
/** Whether a pixel has one value for all colours. */
inline bool isMono(Encoding encoding) { return encoding == Encoding::kMono8 || encoding == Encoding::kMono16; }
/** Whether a pixel shows one of red, green and blue, by its place. */
inline bool isBayer(Encoding encoding) { return encoding >= Encoding::kBayerRggb8; }

/** Colour, 8 bits a channel, as displayed (no gamma is applied anywhere). */
struct Rgb {
  std::uint8_t r = 0;
  std::uint8_t g = 0;
  std::uint8_t b = 0;
  bool operator==(const Rgb& other) const { return r == other.r && g == other.g && b == other.b; }
};

/** Image of height x width pixels, row-major, top row first, no padding; channels interleaved as encoding says.
 *  @tparam Value  a byte, of which one or two are the value of a channel, or what is such a value by itself */
template <typename Value>
struct ImageOf {
  int width = 0;
  int height = 0;
  Encoding encoding = Encoding::kRgb8;
  std::vector<Value> data;  ///< height * stride()

  int channels() const { return channelsOf(encoding); }
  /** Entries of data that are one pixel, and a row of pixels. */
  int pixelSize() const { return sizeof(Value) == 1 ? bytesOf(encoding) : channelsOf(encoding); }
  std::size_t stride() const { return static_cast<std::size_t>(width) * pixelSize(); }
  const Value* pixel(int u, int v) const { return data.data() + v * stride() + u * pixelSize(); }
  Value* pixel(int u, int v) { return data.data() + v * stride() + u * pixelSize(); }
  /** Gives the image this size and encoding; memory is kept when it suffices, contents are undefined. */
  void resize(int new_width, int new_height, Encoding new_encoding) {
    width = new_width;
    height = new_height;
    encoding = new_encoding;
    data.resize(stride() * height);
  }
};

using Image = ImageOf<std::uint8_t>;  ///< as a camera delivers it: the bytes of grey levels

/** The same image with the upper 8 bits of its values, rgb8 or mono8. @pre isDeep(image.encoding) */
Image upperBytes(const Image& image);

/** As light falls on the sensor, before noise and rounding: 257 units are a grey level, so that 65535 are white. */
using FineImage = ImageOf<std::uint16_t>;

/** How many units of an image's values are a grey level. */
template <typename Value>
inline constexpr int kUnitsOf = sizeof(Value) == 1 ? 1 : 257;

/** Whether the value at column x (of channels) of row v is red (0), green (1) or blue (2); 1 for mono images. */
int colorAt(Encoding encoding, int x, int v);

/** What each pixel sees through its colour filter. @param rgb  rgb8  @param encoding  one of the Bayer patterns */
void throughBayerFilter(const FineImage& rgb, Encoding encoding, FineImage& mosaic);

}  // namespace aras_visual_servo_sim
