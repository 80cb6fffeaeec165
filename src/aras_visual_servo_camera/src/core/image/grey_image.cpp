#include "image/grey_image.hpp"

#include <opencv2/imgproc.hpp>
#include <string>

#include "aras_visual_servo_camera/config/errors.hpp"

namespace aras_visual_servo_camera {

cv::Mat greyOf(const ImageView& image, cv::Mat* buffer) {
  const int n = channels(image.format);
  if (image.data == nullptr || image.width_px < 1 || image.height_px < 1 ||
      image.step_bytes < static_cast<std::size_t>(image.width_px) * n)
    throw ShapeError("image: found " + std::to_string(image.width_px) + " x " + std::to_string(image.height_px) +
                     " pixels, " + std::to_string(image.step_bytes) + " bytes a row, allowed at least 1 x 1 and " +
                     std::to_string(n) + " bytes a pixel");
  const cv::Mat view(image.height_px, image.width_px, CV_8UC(n), const_cast<std::uint8_t*>(image.data),
                     image.step_bytes);
  if (image.format == PixelFormat::kMono8) return view;
  const int code = image.format == PixelFormat::kRgb8   ? cv::COLOR_RGB2GRAY
                   : image.format == PixelFormat::kBgr8 ? cv::COLOR_BGR2GRAY
                                                        : cv::COLOR_RGBA2GRAY;
  cv::cvtColor(view, *buffer, code);
  return *buffer;
}

}  // namespace aras_visual_servo_camera
