#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "aras_visual_servo_camera/config/matching_config.hpp"

namespace aras_visual_servo_camera {

/** Motion of things at rest from the camera frame of the goal to that of an image, P' = R P + t. */
struct RigidMotion {
  cv::Matx33d R = cv::Matx33d::eye();
  cv::Vec3d t;
  std::vector<int> inliers;  ///< indices of the points that agree
  double rms_px = 0.0;       ///< of their distance, in the image, from where the motion puts them

  cv::Vec3d apply(const cv::Vec3d& P) const { return R * P + t; }
};

/** The motion that most of the points agree with: samples of three points, whose motion is that of absolute orientation
 *  (Arun, Huang and Blostein, IEEE PAMI 9(5), 1987; Umeyama, PAMI 13(4), 1991), then least squares on the images of the
 *  points and on the logarithms of their depths. The points may lie anywhere, in a plane or not, but not on a line.
 *  @param goal, here  the same points in both frames [m]. @param focal_px  scale of the distances in the image
 *  @return none if fewer than MatchingConfig::min_matches agree. The samples depend on the seed alone. */
std::optional<RigidMotion> findRigidMotion(const std::vector<cv::Vec3d>& goal, const std::vector<cv::Vec3d>& here,
                                           double focal_px, const MatchingConfig& config);

}  // namespace aras_visual_servo_camera
