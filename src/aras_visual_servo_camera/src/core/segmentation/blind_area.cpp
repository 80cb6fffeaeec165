#include "segmentation/blind_area.hpp"

#include <algorithm>
#include <opencv2/imgproc.hpp>

namespace aras_visual_servo_camera {

BlindArea::BlindArea(const PixelMap& map) {
  if (map.separable()) return;
  blind_ = cv::Mat::zeros(map.height(), map.width(), CV_8UC1);
  for (int v = 0; v < map.height(); ++v) {
    for (int u = 0; u < map.width(); ++u) {
      if (map.sees(u, v)) continue;
      blind_.at<std::uint8_t>(v, u) = 255;
      ++count_;
    }
  }
  if (empty()) return;
  constexpr int kReach = 3;  // [px]: an edge is two wide
  cv::dilate(blind_, near_, cv::Mat::ones(2 * kReach + 1, 2 * kReach + 1, CV_8UC1));
}

void BlindArea::fill(std::uint8_t grey, cv::Mat* image) const { image->setTo(grey, blind_); }

bool BlindArea::meets(const std::vector<Run>& runs, int component) const {
  if (empty()) return false;
  return std::any_of(runs.begin(), runs.end(), [&](const Run& run) {
    if (run.component != component) return false;
    const std::uint8_t* row = near_.ptr(run.v);
    return std::find(row + run.u_begin, row + run.u_end, 255) != row + run.u_end;
  });
}

}  // namespace aras_visual_servo_camera
