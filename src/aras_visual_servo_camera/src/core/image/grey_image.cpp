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
                                                          {"mono16", PixelFormat::kMono16},
                                                          {"rgb16", PixelFormat::kRgb16},
                                                          {"bayer_rggb8", PixelFormat::kBayerRggb8},
                                                          {"bayer_bggr8", PixelFormat::kBayerBggr8},
                                                          {"bayer_gbrg8", PixelFormat::kBayerGbrg8},
                                                          {"bayer_grbg8", PixelFormat::kBayerGrbg8}};

}  // namespace

PixelFormat formatNamed(const std::string& encoding) {
  std::string allowed;
  for (const auto& [name, format] : kNames) {
    if (encoding == name) return format;
    allowed += (allowed.empty() ? "" : ", ") + std::string(name);
  }
  throw ShapeError("image encoding: found '" + encoding + "', allowed " + allowed);
}

cv::Mat bytesIn(const ImageView& image) {
  const int n = bytesOf(image.format);
  if (image.data == nullptr || image.width_px < 1 || image.height_px < 1 ||
      image.step_bytes < static_cast<std::size_t>(image.width_px) * n)
    throw ShapeError("image: found " + std::to_string(image.width_px) + " x " + std::to_string(image.height_px) +
                     " pixels, " + std::to_string(image.step_bytes) + " bytes a row, allowed at least 1 x 1 and " +
                     std::to_string(n) + " bytes a pixel");
  const int depth = isDeep(image.format) ? CV_16U : CV_8U;
  const cv::Mat view(image.height_px, image.width_px, CV_MAKETYPE(depth, channels(image.format)),
                     const_cast<std::uint8_t*>(image.data), image.step_bytes);
  cv::Mat bytes;
  if (isBayer(image.format)) {
    if (image.width_px < kLeastOfBayer || image.height_px < kLeastOfBayer)
      throw ShapeError("image: found " + std::to_string(image.width_px) + " x " + std::to_string(image.height_px) +
                       " pixels of a Bayer pattern, allowed at least " + std::to_string(kLeastOfBayer) + " x " +
                       std::to_string(kLeastOfBayer));
    cv::demosaicing(view, bytes,
                    kBayerCodes[static_cast<int>(image.format) - static_cast<int>(PixelFormat::kBayerRggb8)]);
    return bytes;
  }
  if (!isDeep(image.format)) return view;
  view.convertTo(bytes, CV_8U, 255.0 / 65535.0);
  return bytes;
}

cv::Mat greyOf(const ImageView& image, cv::Mat* buffer) {
  const cv::Mat view = bytesIn(image);
  if (view.channels() == 1) return view;
  const int code = image.format == PixelFormat::kBgr8    ? cv::COLOR_BGR2GRAY
                   : image.format == PixelFormat::kRgba8 ? cv::COLOR_RGBA2GRAY
                                                         : cv::COLOR_RGB2GRAY;
  convert(view, code, buffer);
  return *buffer;
}

void requireSize(const ImageView& image, const CameraIntrinsics& intrinsics) {
  if (image.width_px == intrinsics.width() && image.height_px == intrinsics.height()) return;
  throw ShapeError("image: found " + std::to_string(image.width_px) + " x " + std::to_string(image.height_px) +
                   ", allowed " + std::to_string(intrinsics.width()) + " x " + std::to_string(intrinsics.height()) +
                   ", the size in camera_info");
}

void requireDepth(double z_star_m) {
  if (z_star_m > 0.0 && std::isfinite(z_star_m)) return;
  throw ParameterError("reference.z_star_m: found " + std::to_string(z_star_m) + ", allowed > 0");
}

}  // namespace aras_visual_servo_camera
