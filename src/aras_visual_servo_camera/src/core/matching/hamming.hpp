#pragma once

#include <opencv2/core.hpp>
#include <vector>

namespace aras_visual_servo_camera {

/** The nearest row and how far the nearest two are. */
struct NearestTwo {
  int index = -1;                    ///< of the nearest row, the first of equals; -1: there is none
  double first = 0.0, second = 0.0;  ///< distances; second is infinite if there is but one row
};

/** For each row of `queries` the nearest row of `rows`, by the number of bits that differ. Both are 8-bit, of one
 * width. What OpenCV's brute-force matcher finds, with the processor's own counting of bits where it has it. */
std::vector<NearestTwo> nearestByBits(const cv::Mat& queries, const cv::Mat& rows);

}  // namespace aras_visual_servo_camera
