#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

namespace aras_visual_servo_camera {

/** Keypoints of one image matched to those of the goal image: the fields of aras_visual_servo_msgs/MatchFeatures, which
 *  documents each of them. A quantity that does not exist in this image is NaN or an empty list. */
struct MatchFeatures {
  static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

  bool target_visible = false;
  bool has_reference = false;
  bool valid = false;
  std::string fault;
  std::string detector;
  int keypoints = 0;
  int goal_keypoints = 0;
  int matches = 0;
  int inliers = 0;
  double rms_px = kNone;
  double xg = kNone;
  double yg = kNone;
  std::vector<double> point_x, point_y, point_z;
  std::string depth_fault;
  std::vector<double> as_goal_x, as_goal_y, as_goal_z;
  std::vector<double> homography;
  std::vector<double> match_x, match_y;
  std::vector<double> match_goal_x, match_goal_y;
  double z_star_m = kNone;
  std::int64_t reference_stamp_ns = -1;
};

/** Does the same with each field of MatchFeatures, which its message and its Python class have too. */
// clang-format off
#define ARAS_MATCH_FIELDS(DO) \
  DO(target_visible) DO(has_reference) DO(valid) DO(fault) DO(detector) DO(keypoints) DO(goal_keypoints) \
  DO(matches) DO(inliers) DO(rms_px) DO(xg) DO(yg) DO(point_x) DO(point_y) DO(point_z) DO(depth_fault) \
  DO(as_goal_x) DO(as_goal_y) DO(as_goal_z) DO(homography) DO(match_x) DO(match_y) DO(match_goal_x) \
  DO(match_goal_y) DO(z_star_m) DO(reference_stamp_ns)
// clang-format on

}  // namespace aras_visual_servo_camera
