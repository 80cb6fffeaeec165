#pragma once

#include <array>
#include <opencv2/core.hpp>
#include <optional>

#include "aras_visual_servo_camera/image/camera_intrinsics.hpp"

namespace aras_visual_servo_camera {

/** Corners of a tag's black square, normalised, where the lines of its four sides meet. Each line is fitted to points
 * of the side's edge, found across it to a hundredth of a pixel and freed of the lens, which bends the sides in the
 * image.
 *  @param grey  8 bit  @param corners_px  as SeenTag has them, a pixel off at most  @param reach_px  how far from the
 *         side its edge is looked for; within it nothing else must begin
 *  @return nothing where a side shows too few points of an edge from dark to bright, or leaves the image */
std::optional<std::array<cv::Point2d, 4>> cornersOfSides(const cv::Mat& grey,
                                                         const std::array<cv::Point2d, 4>& corners_px, double reach_px,
                                                         const CameraIntrinsics& intrinsics);

}  // namespace aras_visual_servo_camera
