#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "aras_visual_servo_camera/config/matching_config.hpp"

namespace aras_visual_servo_camera {

/** A homography that many matches agree with. */
struct PlaneHomography {
  cv::Matx33d H;             ///< goal to image, scaled to R + t n^T / d: its middle singular value is 1, det > 0
  std::vector<int> inliers;  ///< indices of the matches that agree
  double rms_px;             ///< of their distances

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

}  // namespace aras_visual_servo_camera
