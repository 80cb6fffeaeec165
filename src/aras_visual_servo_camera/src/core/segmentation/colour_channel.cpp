#include "segmentation/colour_channel.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace aras_visual_servo_camera {
namespace {

// The edge of an object lies within kClose pixels of those that have its hue: a pixel that is covered by a half may
// have another hue, as yellow between red and green, and blur and edge weights reach two pixels farther. From kOutside
// pixels on, what is around the object is seen without it, and the object itself kInside pixels within.
constexpr int kClose = 5, kOutside = 3, kInside = 2;
// The line takes up so many greys, which leaves room for noise at both ends, unless its own levels are so few that they
// would be spread by more than kMostGain. Its ends are whole greys: those of most pixels are then not rounded.
constexpr double kMostHalf = 96.0, kMostGain = 2.0;
constexpr double kMiddle = 128.0;
constexpr double kHueTurn = 256.0 / 360.0;  // a degree in OpenCV's HSV_FULL

cv::Mat square(int reach_px) { return cv::Mat::ones(2 * reach_px + 1, 2 * reach_px + 1, CV_8UC1); }

}  // namespace

ColourChannel::ColourChannel(const ObjectColour& colour, double min_chroma) : min_chroma_(min_chroma) {
  const double span = colour.hue_deg[1] - colour.hue_deg[0], turn = span < 0.0 ? span + 360.0 : span;
  for (int k = 0; k < 256; ++k) {
    const double beyond = std::fmod(k / kHueTurn - colour.hue_deg[0] + 720.0, 360.0);
    hues_[k] = beyond <= turn || turn == 360.0;
    saturations_[k] = k >= std::floor(255.0 * colour.saturation[0]) && k <= std::ceil(255.0 * colour.saturation[1]);
  }
}

void ColourChannel::findMembers(const cv::Mat& rgb, const cv::Mat& blind) {
  cv::cvtColor(rgb, hsv_, cv::COLOR_RGB2HSV_FULL);
  members_.create(rgb.rows, rgb.cols, CV_8UC1);
  const double least = 255.0 * min_chroma_;  // saturation times value is 255 times the chroma
  for (int v = 0; v < rgb.rows; ++v) {
    const auto* hsv = hsv_.ptr<cv::Vec3b>(v);
    std::uint8_t* member = members_.ptr(v);
    for (int u = 0; u < rgb.cols; ++u)
      member[u] = hues_[hsv[u][0]] && saturations_[hsv[u][1]] && hsv[u][1] * hsv[u][2] >= least ? 255 : 0;
  }
  if (!blind.empty()) members_.setTo(0, blind);
}

bool ColourChannel::process(const cv::Mat& rgb, const cv::Mat& blind) {
  findMembers(rgb, blind);
  const cv::Rect box = cv::boundingRect(members_);
  if (box.empty()) return false;
  const cv::Rect part = cv::Rect(box.x - kClose, box.y - kClose, box.width + 2 * kClose, box.height + 2 * kClose) &
                        cv::Rect(0, 0, rgb.cols, rgb.rows);
  const cv::Mat pixels = rgb(part), members = members_(part);
  cv::erode(members, inside_, square(kInside));
  cv::dilate(members, around_, square(kOutside - 1));
  cv::dilate(members, close_, square(kClose));
  if (!blind.empty()) close_.setTo(0, blind(part));
  cv::subtract(close_, around_, around_);  // close, and outside
  if (cv::countNonZero(around_) == 0) return false;

  const bool thin = cv::countNonZero(inside_) == 0;
  const cv::Scalar object = cv::mean(pixels, thin ? members : inside_), background = cv::mean(pixels, around_);
  const cv::Vec3d between(object[0] - background[0], object[1] - background[1], object[2] - background[2]);
  const double grey = (between[0] + between[1] + between[2]) / 3.0;
  const cv::Vec3d line = between - cv::Vec3d(grey, grey, grey);
  const double length = cv::norm(line);
  if (!(length >= 1.0)) return false;
  const double half = std::floor(std::min(kMostHalf, 0.5 * kMostGain * length));
  gain_ = 2.0 * half / length;
  background_grey_ = static_cast<int>(kMiddle - half);
  const cv::Vec3d a = line * (gain_ / length);
  const cv::Vec3d both(object[0] + background[0], object[1] + background[1], object[2] + background[2]);
  cv::transform(pixels, places_, cv::Matx14d(a[0], a[1], a[2], kMiddle - 0.5 * a.dot(both)));
  grey_.create(rgb.rows, rgb.cols, CV_8UC1);
  grey_.setTo(background_grey_);
  places_.copyTo(grey_(part), close_);
  left_out_ = static_cast<int>(rgb.total()) - cv::countNonZero(close_);
  return true;
}

}  // namespace aras_visual_servo_camera
