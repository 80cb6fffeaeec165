#pragma once

#include <opencv2/core.hpp>

#include "aras_visual_servo_camera/image/camera_intrinsics.hpp"
#include "aras_visual_servo_camera/image/image_view.hpp"

namespace aras_visual_servo_camera {

/** The pixels of a view, 8 bits a value: its own, or, of values of 16 bits, 255 / 65535 of them, rounded, as cv_bridge
 *  converts them, or, of a Bayer pattern, rgb, the missing colours interpolated linearly. @throws ShapeError if the
 * view has no pixels, or rows shorter than them */
cv::Mat bytesIn(const ImageView& image);

/** The image as 8-bit grey: the pixels of the view themselves if it is mono8.
 *  @param buffer  memory that is used again for what is converted
 *  @throws ShapeError if the view has no pixels, or rows shorter than them */
cv::Mat greyOf(const ImageView& image, cv::Mat* buffer);

/** Requires that an image has the size of its camera. @throws ShapeError */
void requireSize(const ImageView& image, const CameraIntrinsics& intrinsics);

/** Requires that the depth of a goal is finite and > 0. @throws ParameterError */
void requireDepth(double z_star_m);

}  // namespace aras_visual_servo_camera
