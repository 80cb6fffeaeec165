#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

namespace aras_visual_servo_camera {

/** The corners and the pose of an AprilTag in one image: the fields of aras_visual_servo_msgs/TagFeatures, which
 *  documents each of them. A quantity that does not exist in this image is NaN or an empty list. */
struct TagFeatures {
  static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

  bool target_visible = false;
  bool has_reference = false;
  bool valid = false;
  std::string fault;
  std::string family;
  int id = 0;
  int tags = 0;
  double side_px = kNone;
  double xg = kNone;
  double yg = kNone;
  std::vector<double> point_x, point_y;
  std::vector<double> homography;
  std::vector<double> position_m;
  std::vector<double> orientation;
  double pose_error = kNone;
  double other_pose_error = kNone;
  double z_star_m = kNone;
  std::int64_t reference_stamp_ns = -1;
};

/** Does the same with each field of TagFeatures, which its message and its Python class have too. */
// clang-format off
#define ARAS_TAG_FIELDS(DO) \
  DO(target_visible) DO(has_reference) DO(valid) DO(fault) DO(family) DO(id) DO(tags) DO(side_px) DO(xg) \
  DO(yg) DO(point_x) DO(point_y) DO(homography) DO(position_m) DO(orientation) DO(pose_error) \
  DO(other_pose_error) DO(z_star_m) DO(reference_stamp_ns)
// clang-format on

}  // namespace aras_visual_servo_camera
