#pragma once

#include <opencv2/core.hpp>
#include <utility>
#include <vector>

namespace aras_visual_servo_camera {

/** Weights of a row or column of pixels, the first of them at pixel `first`; beyond them they are zero. */
struct Window {
  int first;
  std::vector<float> weights;
};

/** Sums over an image whose weights are a product of one along the columns and one along the rows. */
class SeparableSums {
 public:
  SeparableSums() = default;
  /** @param along_u, along_v  windows within the image
   *  @param kept  pairs (index in along_u, index in along_v) of the sums that are wanted, in their order */
  SeparableSums(std::vector<Window> along_u, std::vector<Window> along_v, std::vector<std::pair<int, int>> kept);

  /** Of an image of single precision. Same image, same bits. */
  std::vector<double> of(const cv::Mat& image) const;

 private:
  std::vector<Window> along_u_, along_v_;
  std::vector<std::pair<int, int>> kept_;
};

}  // namespace aras_visual_servo_camera
