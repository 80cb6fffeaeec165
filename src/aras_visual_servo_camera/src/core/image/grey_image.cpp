#include "image/grey_image.hpp"

#include <cmath>
#include <cstring>
#include <opencv2/imgproc.hpp>
#include <string>
#include <utility>

#include "aras_visual_servo_camera/config/errors.hpp"

namespace aras_visual_servo_camera {
namespace {

/** Whether all bytes are the same. */
bool isOneByte(const std::uint8_t* bytes, std::size_t count) { return std::memcmp(bytes, bytes + 1, count - 1) == 0; }

/** cvtColor of the rows that need it. The grey of r = g = b is the same byte, and most rows of most images of a
 *  simulated camera hold nothing but a grey background, which a comparison finds ten times as fast. */
void convert(const cv::Mat& view, int code, cv::Mat* grey) {
  grey->create(view.rows, view.cols, CV_8UC1);
  const std::size_t bytes = view.cols * view.elemSize();
  int begin = 0;  // first row that is not converted yet
  for (int v = 0; v <= view.rows; ++v) {
    const bool one_byte = v < view.rows && isOneByte(view.ptr(v), bytes);
    if (v < view.rows && !one_byte) continue;
    if (begin < v) {
      cv::Mat rows = grey->rowRange(begin, v);
      cv::cvtColor(view.rowRange(begin, v), rows, code);
    }
    if (one_byte) std::memset(grey->ptr(v), *view.ptr(v), view.cols);
    begin = v + 1;
  }
}

constexpr int kLeastOfBayer = 3;  // pixels each way, which the interpolation takes its colours from

/** Of the patterns in the order of PixelFormat. OpenCV names a pattern after its second row. */
constexpr int kBayerCodes[] = {cv::COLOR_BayerBG2RGB, cv::COLOR_BayerRG2RGB, cv::COLOR_BayerGR2RGB,
                               cv::COLOR_BayerGB2RGB};

constexpr std::pair<const char*, PixelFormat> kNames[] = {{"rgb8", PixelFormat::kRgb8},
                                                          {"bgr8", PixelFormat::kBgr8},
                                                          {"mono8", PixelFormat::kMono8},
                                                          {"rgba8", PixelFormat::kRgba8},
                                                          {"bgra8", PixelFormat::kBgra8},
                                                          {"mono16", PixelFormat::kMono16},
                                                          {"rgb16", PixelFormat::kRgb16},
                                                          {"bgr16", PixelFormat::kBgr16},
                                                          {"rgba16", PixelFormat::kRgba16},
                                                          {"bgra16", PixelFormat::kBgra16},
                                                          {"bayer_rggb8", PixelFormat::kBayerRggb8},
                                                          {"bayer_bggr8", PixelFormat::kBayerBggr8},
                                                          {"bayer_gbrg8", PixelFormat::kBayerGbrg8},
                                                          {"bayer_grbg8", PixelFormat::kBayerGrbg8},
                                                          {"bayer_rggb16", PixelFormat::kBayerRggb16},
                                                          {"bayer_bggr16", PixelFormat::kBayerBggr16},
                                                          {"bayer_gbrg16", PixelFormat::kBayerGbrg16},
                                                          {"bayer_grbg16", PixelFormat::kBayerGrbg16},
                                                          {"yuv422", PixelFormat::kYuv422},
                                                          {"yuv422_yuy2", PixelFormat::kYuv422Yuy2},
                                                          {"8UC1", PixelFormat::kMono8},
                                                          {"8UC3", PixelFormat::kBgr8},
                                                          {"8UC4", PixelFormat::kBgra8},
                                                          {"16UC1", PixelFormat::kMono16},
                                                          {"16UC3", PixelFormat::kBgr16},
                                                          {"16UC4", PixelFormat::kBgra16}};

std::string sizeOf(const ImageView& image) {
  return "image: found " + std::to_string(image.width_px) + " x " + std::to_string(image.height_px) + " pixels";
}

/** The values of a view as OpenCV takes them: in the processor's order and at even addresses. */
cv::Mat valuesIn(const ImageView& image) {
  const int n = bytesOf(image.format);
  if (image.data == nullptr || image.width_px < 1 || image.height_px < 1 ||
      image.step_bytes < static_cast<std::size_t>(image.width_px) * n)
    throw ShapeError(sizeOf(image) + ", " + std::to_string(image.step_bytes) +
                     " bytes a row, allowed at least 1 x 1 and " + std::to_string(n) + " bytes a pixel");
  const bool deep = isDeep(image.format);
  const int type = CV_MAKETYPE(deep ? CV_16U : CV_8U, channels(image.format));
  const bool odd = image.step_bytes % 2 != 0 || reinterpret_cast<std::uintptr_t>(image.data) % 2 != 0;
  if (!deep || !(odd || image.upper_byte_first))
    return cv::Mat(image.height_px, image.width_px, type, const_cast<std::uint8_t*>(image.data), image.step_bytes);
  cv::Mat values(image.height_px, image.width_px, type);
  for (int v = 0; v < values.rows; ++v) {
    auto* row = values.ptr<std::uint16_t>(v);
    const int count = values.cols * values.channels();
    std::memcpy(row, image.data + v * image.step_bytes, static_cast<std::size_t>(count) * 2);
    for (int k = 0; image.upper_byte_first && k < count; ++k)
      row[k] = static_cast<std::uint16_t>(row[k] << 8 | row[k] >> 8);
  }
  return values;
}

/** The code of cvtColor from a format, which is not a Bayer pattern, to grey or to rgb; -1: none is needed. */
int codeOf(PixelFormat format, bool to_grey) {
  switch (shallow(format)) {
    case PixelFormat::kMono8:
      return to_grey ? -1 : cv::COLOR_GRAY2RGB;
    case PixelFormat::kBgr8:
      return to_grey ? cv::COLOR_BGR2GRAY : cv::COLOR_BGR2RGB;
    case PixelFormat::kRgba8:
      return to_grey ? cv::COLOR_RGBA2GRAY : cv::COLOR_RGBA2RGB;
    case PixelFormat::kBgra8:
      return to_grey ? cv::COLOR_BGRA2GRAY : cv::COLOR_BGRA2RGB;
    case PixelFormat::kYuv422:
      return to_grey ? cv::COLOR_YUV2GRAY_UYVY : cv::COLOR_YUV2RGB_UYVY;
    case PixelFormat::kYuv422Yuy2:
      return to_grey ? cv::COLOR_YUV2GRAY_YUY2 : cv::COLOR_YUV2RGB_YUY2;
    default:
      return to_grey ? cv::COLOR_RGB2GRAY : -1;
  }
}

}  // namespace

PixelFormat formatNamed(const std::string& encoding) {
  std::string allowed;
  for (const auto& [name, format] : kNames) {
    if (encoding == name) return format;
    allowed += (allowed.empty() ? "" : ", ") + std::string(name);
  }
  throw ShapeError("image encoding: found '" + encoding + "', allowed " + allowed);
}

cv::Mat coloursIn(const ImageView& image) {
  const cv::Mat values = valuesIn(image);
  if (isYuv(image.format) && image.width_px % 2 != 0)
    throw ShapeError(sizeOf(image) + " that share their colour in pairs, allowed an even width");
  if (!isBayer(image.format)) return values;
  if (image.width_px < kLeastOfBayer || image.height_px < kLeastOfBayer)
    throw ShapeError(sizeOf(image) + " of a Bayer pattern, allowed at least " + std::to_string(kLeastOfBayer) + " x " +
                     std::to_string(kLeastOfBayer));
  cv::Mat rgb;
  cv::demosaicing(values, rgb,
                  kBayerCodes[static_cast<int>(shallow(image.format)) - static_cast<int>(PixelFormat::kBayerRggb8)]);
  return rgb;
}

cv::Mat inBytes(const cv::Mat& values, int white) {
  if (values.depth() == CV_8U) return values;
  cv::Mat bytes;
  values.convertTo(bytes, CV_8U, 255.0 / white);
  return bytes;
}

cv::Mat rgbOf(const ImageView& image) {
  const cv::Mat colours = coloursIn(image);
  const int code = codeOf(image.format, false);
  if (code < 0) return colours;
  cv::Mat rgb;
  cv::cvtColor(colours, rgb, code);
  return rgb;
}

cv::Mat greyOf(const ImageView& image, cv::Mat* buffer) {
  const cv::Mat colours = inBytes(coloursIn(image), image.white);
  const int code = codeOf(image.format, true);
  if (code < 0) return colours;
  convert(colours, code, buffer);
  return *buffer;
}

void GreyReader::findWhite(ImageView* image) {
  if (!isDeep(image->format)) return;
  double most = 0.0;
  cv::Mat values = valuesIn(*image);
  if (values.channels() == 4) cv::cvtColor(values, values, cv::COLOR_RGBA2RGB);  // opacity is no light
  cv::minMaxLoc(values.reshape(1), nullptr, &most);
  for (int bits = 8; bits <= 16 && (bits == 8 || white_ < most); bits += 2) white_ = std::max(white_, (1 << bits) - 1);
  image->white = white_;
}

cv::Mat GreyReader::read(ImageView image) {
  findWhite(&image);
  return greyOf(image, &buffer_);
}

cv::Mat GreyReader::readRgb(ImageView image) {
  if (shallow(image.format) == PixelFormat::kMono8)
    throw ShapeError(std::string("image: found ") + (isDeep(image.format) ? "mono16" : "mono8") +
                     ", allowed an encoding with colours, because vision.object is a colour");
  findWhite(&image);
  return inBytes(rgbOf(image), image.white);
}

void requireSize(const ImageView& image, const CameraIntrinsics& intrinsics) {
  if (image.width_px == intrinsics.width() && image.height_px == intrinsics.height()) return;
  throw ShapeError("image: found " + std::to_string(image.width_px) + " x " + std::to_string(image.height_px) +
                   ", allowed " + std::to_string(intrinsics.width()) + " x " + std::to_string(intrinsics.height()) +
                   ", the size in camera_info after binning and roi");
}

void requireDepth(double z_star_m) {
  if (z_star_m > 0.0 && std::isfinite(z_star_m)) return;
  throw ParameterError("reference.z_star_m: found " + std::to_string(z_star_m) + ", allowed > 0");
}

}  // namespace aras_visual_servo_camera
