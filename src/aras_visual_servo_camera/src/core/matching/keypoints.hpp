#pragma once

#include <array>
#include <opencv2/core.hpp>
#include <opencv2/features2d.hpp>
#include <string>
#include <vector>

#include "aras_visual_servo_camera/config/vision_config.hpp"
#include "aras_visual_servo_camera/image/camera_intrinsics.hpp"

namespace aras_visual_servo_camera {

/** The keypoints of one image. */
struct Keypoints {
  std::vector<cv::Point2d> xy;  ///< normalised coordinates
  cv::Mat descriptors;          ///< a row for each
  std::vector<double> z;        ///< depth of each [m], NaN in holes; empty where no depth image is asked for
  std::string depth_fault;      ///< why there are none

  int count() const { return static_cast<int>(xy.size()); }
  bool operator==(const Keypoints& other) const;

  /** Corners of the box about the middle of the keypoints, as far from it as their standard deviation, clockwise from
   *  the upper left. Needs a keypoint. */
  std::array<cv::Point2d, 4> box() const;
  /** How many have a depth, and the median of these depths [m]; NaN where none has. */
  int withDepth() const;
  double medianDepth() const;
};

/** Finds and describes keypoints with OpenCV. It sets OpenCV to one thread, for the whole process: then the order of
 * the keypoints is that of the image, and processes that were forked do not wait for threads that they do not have. It
 * also lets the process keep up to 256 MiB of freed memory. */
class KeypointFinder {
 public:
  explicit KeypointFinder(const MatchingConfig& config);

  /** @param grey  8-bit image of the size of the intrinsics
   *  @param found  at most MatchingConfig::keypoints of them; those whose pixels have no ray are left out */
  void find(const cv::Mat& grey, const CameraIntrinsics& intrinsics, Keypoints* found) const;

  /** Pairs (index in `image`, index in `goal`) that pass the ratio test, each keypoint of the goal at most once. */
  std::vector<std::array<int, 2>> match(const Keypoints& image, const Keypoints& goal) const;

 private:
  /** What OpenCV leaves out of the place of a keypoint, along u and along v [px]. */
  double shiftOf(const cv::KeyPoint& keypoint) const;

  KeypointDetector name_;
  cv::Ptr<cv::Feature2D> detector_;
  cv::NormTypes norm_;
  int most_;
  double ratio_;
};

/** The nearest row and how far the nearest two are. */
struct NearestTwo {
  int index = -1;                    ///< of the nearest row, the first of equals; -1: there is none
  double first = 0.0, second = 0.0;  ///< distances; second is infinite if there is but one row
};

/** For each row of `queries` the nearest row of `rows`, by the number of bits that differ. Both are 8-bit, of one
 * width. What OpenCV's brute-force matcher finds, with the processor's own counting of bits where it has it. */
std::vector<NearestTwo> nearestByBits(const cv::Mat& queries, const cv::Mat& rows);

}  // namespace aras_visual_servo_camera
