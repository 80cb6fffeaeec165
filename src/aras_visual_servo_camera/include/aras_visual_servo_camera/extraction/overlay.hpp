#pragma once

#include <cstdint>
#include <vector>

#include "aras_visual_servo_camera/image/camera_intrinsics.hpp"
#include "aras_visual_servo_camera/image/image_view.hpp"
#include "aras_visual_servo_camera/image/object_mask.hpp"
#include "aras_visual_servo_camera/moments/moment_features.hpp"

namespace aras_visual_servo_camera {

/** The image with the object's contour (green), centroid (red), axis (yellow: alpha, arrow head where it is resolved)
 * and points (magenta, numbered from 1 as in x1, y1).
 *  @return rgb8, row-major, 3 * width * height bytes */
std::vector<std::uint8_t> drawOverlay(const ImageView& image, const ObjectMask& mask, const MomentFeatures& features,
                                      const CameraIntrinsics& intrinsics);

/** The image as rgb8 or, of values of 16 bits, rgb16. @param out  3 * width * height values */
void toRgb(const ImageView& image, void* out);

}  // namespace aras_visual_servo_camera
