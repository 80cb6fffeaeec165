#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

#include "aras_visual_servo_camera/image/pixel_map.hpp"
#include "segmentation/components.hpp"

namespace aras_visual_servo_camera {

/** Pixels without a usable ray, such as those that a fisheye sees beyond CameraIntrinsics::kWidestAngle and those
 *  outside its circle. The segmentation treats them as lying outside the image. */
class BlindArea {
 public:
  BlindArea() = default;
  explicit BlindArea(const PixelMap& map);

  bool empty() const { return count_ == 0; }
  /** Number of such pixels. */
  int count() const { return count_; }
  /** Sets all these pixels to one grey. */
  void fill(std::uint8_t grey, cv::Mat* image) const;
  /** Whether a component comes so near to these pixels that its edge may lie among them. */
  bool meets(const std::vector<Run>& runs, int component) const;

 private:
  int count_ = 0;
  cv::Mat blind_, near_;  // 255 where it is so
};

}  // namespace aras_visual_servo_camera
