#pragma once

#include <opencv2/core.hpp>

#include "aras_visual_servo_camera/image/camera_intrinsics.hpp"
#include "aras_visual_servo_camera/image/image_view.hpp"

namespace aras_visual_servo_camera {

/** The colours of a view in its own depth, in the processor's order: those of the view themselves, or, of a Bayer
 * pattern or YUV, rgb, the missing colours interpolated linearly. @throws ShapeError if the view has no pixels, or rows
 * shorter than them */
cv::Mat coloursIn(const ImageView& image);

/** The image as rgb in its own depth; of grey, three times that. @throws ShapeError as coloursIn() */
cv::Mat rgbOf(const ImageView& image);

/** Values of 16 bits as 8 bits, 255 / white of them, rounded; others are returned as they are. */
cv::Mat inBytes(const cv::Mat& values, int white);

/** The image as 8-bit grey: the pixels of the view themselves if it is mono8.
 *  @param buffer  memory that is used again for what is converted
 *  @throws ShapeError if the view has no pixels, or rows shorter than them */
cv::Mat greyOf(const ImageView& image, cv::Mat* buffer);

/** Reads the images of one camera as 8-bit grey or rgb, and finds out how many bits its values of 16 bits use: white is
 * the largest value of the fewest of 8, 10, 12, 14 and 16 bits that all images so far have kept to. */
class GreyReader {
 public:
  /** As greyOf(); valid until the next call. */
  cv::Mat read(ImageView image);
  /** The image as rgb of 8 bits. @throws ShapeError of a mono image too */
  cv::Mat readRgb(ImageView image);
  /** ImageView::white of the last image. */
  int white() const { return white_; }

 private:
  /** Sets ImageView::white, having seen the values of this image too. */
  void findWhite(ImageView* image);

  cv::Mat buffer_;
  int white_ = 0;
};

/** Requires that an image has the size of its camera. @throws ShapeError */
void requireSize(const ImageView& image, const CameraIntrinsics& intrinsics);

/** Requires that the depth of a goal is finite and > 0. @throws ParameterError */
void requireDepth(double z_star_m);

}  // namespace aras_visual_servo_camera
