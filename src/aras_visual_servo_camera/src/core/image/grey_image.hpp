#pragma once

#include <opencv2/core.hpp>

#include "aras_visual_servo_camera/image/image_view.hpp"

namespace aras_visual_servo_camera {

/** The image as 8-bit grey: the pixels of the view themselves if it is mono8, else in `buffer`.
 *  @throws ShapeError if the view has no pixels, or rows shorter than them */
cv::Mat greyOf(const ImageView& image, cv::Mat* buffer);

}  // namespace aras_visual_servo_camera
