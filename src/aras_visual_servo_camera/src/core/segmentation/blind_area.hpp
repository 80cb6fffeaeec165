#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

#include "aras_visual_servo_camera/image/pixel_map.hpp"
#include "segmentation/components.hpp"

namespace aras_visual_servo_camera {

/** Pixels without a ray that counts, such as those a fisheye sees beyond CameraIntrinsics::kWidestAngle and those
 *  outside its circle. To the segmentation the image ends where they begin. */
class BlindArea {
 public:
  BlindArea() = default;
  explicit BlindArea(const PixelMap& map);

  bool empty() const { return count_ == 0; }
  /** Number of such pixels. */
  int count() const { return count_; }
  /** Gives them one grey. */
  void fill(std::uint8_t grey, cv::Mat* image) const;
  /** Whether a component comes so near that its edge may lie beyond. */
  bool meets(const std::vector<Run>& runs, int component) const;

 private:
  int count_ = 0;
  cv::Mat blind_, near_;  // 255 where it is so
};

}  // namespace aras_visual_servo_camera
