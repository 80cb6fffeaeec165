#include "aras_visual_servo_camera/extraction/overlay.hpp"

#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "image/grey_image.hpp"

namespace aras_visual_servo_camera {

void toRgb(const ImageView& image, void* out) {
  const cv::Mat rgb = rgbOf(image);
  rgb.copyTo(cv::Mat(rgb.size(), rgb.type(), out));
}

std::vector<std::uint8_t> drawOverlay(const ImageView& image, const ObjectMask& mask, const MomentFeatures& features,
                                      const CameraIntrinsics& intrinsics) {
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(3) * image.width_px * image.height_px);
  inBytes(rgbOf(image), image.white).copyTo(cv::Mat(image.height_px, image.width_px, CV_8UC3, bytes.data()));
  if (!features.target_visible) return bytes;
  cv::Mat rgb(image.height_px, image.width_px, CV_8UC3, bytes.data());

  cv::Mat weights(mask.height_px, mask.width_px, CV_8UC1);
  mask.render(weights.ptr());
  std::vector<std::vector<cv::Point>> contours;
  cv::findContours(weights > 127, contours, cv::RETR_EXTERNAL, cv::CHAIN_APPROX_NONE);
  cv::drawContours(rgb, contours, -1, cv::Scalar(0, 255, 0));

  const auto pixel = [&intrinsics](double x, double y) {
    const std::array<double, 2> p = intrinsics.project(x, y);
    return cv::Point(static_cast<int>(std::lround(p[0])), static_cast<int>(std::lround(p[1])));
  };
  const cv::Point centre = pixel(features.xg, features.yg);
  if (std::isfinite(features.alpha)) {
    const double reach = 0.5 * std::sqrt(features.area);
    const double dx = reach * std::cos(features.alpha), dy = reach * std::sin(features.alpha);
    const cv::Point tip = pixel(features.xg + dx, features.yg + dy);
    const cv::Scalar yellow(255, 255, 0);
    if (features.has_reference && !features.symmetric) {
      cv::arrowedLine(rgb, centre, tip, yellow, 1, cv::LINE_8, 0, 0.25);
    } else {
      cv::line(rgb, pixel(features.xg - dx, features.yg - dy), tip, yellow);
    }
  }
  for (std::size_t k = 0; k < features.point_x.size(); ++k) {
    const cv::Point at = pixel(features.point_x[k], features.point_y[k]);
    const cv::Scalar magenta(255, 0, 255);
    cv::circle(rgb, at, 2, magenta, cv::FILLED);
    cv::putText(rgb, std::to_string(k + 1), at + cv::Point(4, -4), cv::FONT_HERSHEY_SIMPLEX, 0.4, magenta);
  }
  cv::circle(rgb, centre, 2, cv::Scalar(255, 0, 0), cv::FILLED);
  return bytes;
}

}  // namespace aras_visual_servo_camera
