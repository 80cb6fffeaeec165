#pragma once

#include <array>
#include <cstdint>
#include <opencv2/core.hpp>

#include "aras_visual_servo_camera/config/vision_config.hpp"

namespace aras_visual_servo_camera {

/** Makes a grey image of a colour image, in which the object is bright and what is around it dark.
 *
 *  An edge pixel mixes the colours of both sides in proportion to their areas. Its grey is the place of its chroma on
 * the line between both, so it is linear in the covered area. Chroma is the part of (r, g, b) that is perpendicular to
 * grey: an added grey, as between a black and a white background, does not change it. The ends of the line are the mean
 *  colours of the pixels of the wanted hue and of those close by; Segmentation estimates the levels themselves from the
 *  grey image. */
class ColourChannel {
 public:
  /** @param min_chroma  pixels whose largest and smallest values differ by less have no hue */
  ColourChannel(const ObjectColour& colour, double min_chroma);

  /** @param rgb  CV_8UC3
   *  @param blind  CV_8UC1, not 0 where a pixel is to be ignored; empty: nowhere
   *  @return whether there are pixels of the colour, and others close to them; the results below are of such an image
   */
  bool process(const cv::Mat& rgb, const cv::Mat& blind);

  /** CV_8UC1: the place on the line. Pixels that are not close to one of the colour have the grey backgroundGrey(). */
  const cv::Mat& grey() const { return grey_; }
  /** CV_8UC1: 255 where a pixel has the colour, else 0. */
  const cv::Mat& members() const { return members_; }
  int backgroundGrey() const { return background_grey_; }
  /** Number of pixels that are not close to one of the colour. */
  int leftOut() const { return left_out_; }
  /** Greys for each level of chroma. */
  double gain() const { return gain_; }

 private:
  void findMembers(const cv::Mat& rgb, const cv::Mat& blind);

  std::array<bool, 256> hues_{}, saturations_{};  // that the object has, by the values of OpenCV's HSV
  double min_chroma_;
  cv::Mat hsv_, members_, inside_, close_, around_, places_, grey_;
  int background_grey_ = 0, left_out_ = 0;
  double gain_ = 1.0;
};

}  // namespace aras_visual_servo_camera
