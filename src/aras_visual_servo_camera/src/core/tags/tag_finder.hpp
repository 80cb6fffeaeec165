#pragma once

#include <array>
#include <memory>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "aras_visual_servo_camera/config/tag_config.hpp"

namespace aras_visual_servo_camera {

/** One tag in an image: the corners of its black square as one who reads the tag upright sees them, from the upper left
 *  one on clockwise, in pixels whose middles are whole numbers. */
struct SeenTag {
  int id;
  std::array<cv::Point2d, 4> corners_px;
};

/** Finds the tags of a family, with ViSP's copy of the AprilTag library, in one thread. */
class TagFinder {
 public:
  explicit TagFinder(const std::string& family);
  ~TagFinder();
  /** @param grey  8 bit */
  std::vector<SeenTag> find(const cv::Mat& grey);

 private:
  struct Detector;
  std::unique_ptr<Detector> detector_;
};

}  // namespace aras_visual_servo_camera
