#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "aras_visual_servo_camera/config/vision_config.hpp"

namespace aras_visual_servo_camera {

/** A homography that many matches agree with. */
struct PlaneHomography {
  cv::Matx33d H =
      cv::Matx33d::eye();    ///< goal to image, scaled to R + t n^T / d: its middle singular value is 1, det > 0
  std::vector<int> inliers;  ///< indices of the matches that agree
  double rms_px = 0.0;       ///< of their distances

  /** Where it puts a point of the goal. */
  cv::Point2d apply(const cv::Point2d& p) const;
};

/** The homography that takes points of the goal to those of an image, both normalised: RANSAC (OpenCV's USAC, one
 *  thread, the seed of the configuration), then least squares over the matches that agree.
 *  @param focal_px  pixels per unit of the coordinates, for MatchingConfig::inlier_px
 *  @return nothing if fewer than MatchingConfig::min_matches agree, or if the homography shows the plane from behind,
 *      squeezed to a line, or more than 20 times as large or as small as in the goal */
std::optional<PlaneHomography> findHomography(const std::vector<cv::Point2d>& goal,
                                              const std::vector<cv::Point2d>& image, double focal_px,
                                              const MatchingConfig& config);

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
