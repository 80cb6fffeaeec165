#include "conversions.hpp"

#include <sensor_msgs/image_encodings.h>

#include <algorithm>
#include <array>

#include "aras_visual_servo_camera/config/errors.hpp"

namespace aras_visual_servo_camera {

CameraIntrinsics toIntrinsics(const sensor_msgs::CameraInfo& info) {
  if (info.binning_x > 1 || info.binning_y > 1)
    throw ParameterError("camera_info/binning: found " + std::to_string(info.binning_x) + " x " +
                         std::to_string(info.binning_y) + ", allowed 0 or 1");
  const auto& roi = info.roi;
  const bool whole = (roi.width == 0 || roi.width == info.width) && (roi.height == 0 || roi.height == info.height);
  if (roi.x_offset != 0 || roi.y_offset != 0 || !whole)
    throw ParameterError("camera_info/roi: found a part of the image, allowed the whole image");
  std::array<double, 9> K;
  std::copy(info.K.begin(), info.K.end(), K.begin());
  return CameraIntrinsics(static_cast<int>(info.width), static_cast<int>(info.height), K, info.distortion_model,
                          info.D);
}

ImageView toView(const sensor_msgs::Image& image) {
  ImageView view;
  view.format = formatNamed(image.encoding);
  if (isDeep(view.format) && (image.is_bigendian || image.step % 2 != 0))
    throw ShapeError("image: found is_bigendian " + std::to_string(image.is_bigendian) + " and rows of " +
                     std::to_string(image.step) + " bytes, allowed 0 and an even number with " + image.encoding);
  const std::size_t row = static_cast<std::size_t>(image.width) * bytesOf(view.format);
  if (image.step < row || image.data.size() < static_cast<std::size_t>(image.step) * image.height)
    throw ShapeError("image: found " + std::to_string(image.data.size()) + " bytes in rows of " +
                     std::to_string(image.step) + ", allowed at least " + std::to_string(row * image.height));
  view.data = image.data.data();
  view.width_px = static_cast<int>(image.width);
  view.height_px = static_cast<int>(image.height);
  view.step_bytes = image.step;
  return view;
}

DepthView toDepthView(const sensor_msgs::Image& image) {
  namespace enc = sensor_msgs::image_encodings;
  DepthView view;
  view.millimetres = image.encoding == enc::TYPE_16UC1 || image.encoding == enc::MONO16;
  if (!view.millimetres && image.encoding != enc::TYPE_32FC1)
    throw ShapeError("depth image encoding: found '" + image.encoding + "', allowed 32FC1 [m], 16UC1 [mm]");
  const std::size_t row = static_cast<std::size_t>(image.width) * (view.millimetres ? 2 : 4);
  if (image.is_bigendian || image.step < row || image.data.size() < static_cast<std::size_t>(image.step) * image.height)
    throw ShapeError("depth image: found is_bigendian " + std::to_string(image.is_bigendian) + " and " +
                     std::to_string(image.data.size()) + " bytes in rows of " + std::to_string(image.step) +
                     ", allowed 0 and at least " + std::to_string(row * image.height));
  view.data = image.data.data();
  view.width_px = static_cast<int>(image.width);
  view.height_px = static_cast<int>(image.height);
  view.step_bytes = image.step;
  return view;
}

aras_visual_servo_msgs::MomentFeatures toMessage(const MomentFeatures& f) {
  aras_visual_servo_msgs::MomentFeatures msg;
  msg.target_visible = f.target_visible;
  msg.touches_border = f.touches_border;
  msg.symmetric = f.symmetric;
  msg.has_reference = f.has_reference;
  msg.valid = f.valid;
  msg.ambiguous = f.ambiguous;
  msg.components = f.components;
  msg.area = f.area;
  msg.xg = f.xg;
  msg.yg = f.yg;
  msg.alpha = f.alpha;
  msg.xn = f.xn;
  msg.yn = f.yn;
  msg.an = f.an;
  msg.z_star_m = f.z_star_m;
  msg.area_star = f.area_star;
  msg.reference_stamp_ns = f.reference_stamp_ns;
  msg.orientation_condition = f.orientation_condition;
  msg.asymmetry = f.asymmetry;
  msg.moment_names = f.moment_names;
  msg.m = f.m;
  msg.mu = f.mu;
  msg.point_x = f.point_x;
  msg.point_y = f.point_y;
  msg.point_z = f.point_z;
  msg.depth_fault = f.depth_fault;
  msg.ray_x = f.ray_x;
  msg.ray_y = f.ray_y;
  msg.ray_z = f.ray_z;
  msg.kernel_x = f.kernel_x;
  msg.kernel_y = f.kernel_y;
  return msg;
}

aras_visual_servo_msgs::PhotometricFeatures toMessage(const PhotometricFeatures& f) {
  aras_visual_servo_msgs::PhotometricFeatures msg;
  msg.target_visible = f.target_visible;
  msg.has_reference = f.has_reference;
  msg.valid = f.valid;
  msg.fault = f.fault;
  msg.interaction = f.interaction;
  msg.level = f.level;
  msg.levels = f.levels;
  msg.pixels = f.pixels;
  msg.rms = f.rms;
  msg.cost = f.cost;
  msg.H = f.H;
  msg.b = f.b;
  msg.condition = f.condition;
  msg.motion_px = f.motion_px;
  msg.z_star_m = f.z_star_m;
  msg.reference_hash = f.reference_hash;
  msg.reference_stamp_ns = f.reference_stamp_ns;
  return msg;
}

aras_visual_servo_msgs::MatchFeatures toMessage(const MatchFeatures& f) {
  aras_visual_servo_msgs::MatchFeatures msg;
  msg.target_visible = f.target_visible;
  msg.has_reference = f.has_reference;
  msg.valid = f.valid;
  msg.fault = f.fault;
  msg.detector = f.detector;
  msg.keypoints = f.keypoints;
  msg.goal_keypoints = f.goal_keypoints;
  msg.matches = f.matches;
  msg.inliers = f.inliers;
  msg.rms_px = f.rms_px;
  msg.xg = f.xg;
  msg.yg = f.yg;
  msg.point_x = f.point_x;
  msg.point_y = f.point_y;
  msg.point_z = f.point_z;
  msg.depth_fault = f.depth_fault;
  msg.as_goal_x = f.as_goal_x;
  msg.as_goal_y = f.as_goal_y;
  msg.as_goal_z = f.as_goal_z;
  msg.homography = f.homography;
  msg.match_x = f.match_x;
  msg.match_y = f.match_y;
  msg.match_goal_x = f.match_goal_x;
  msg.match_goal_y = f.match_goal_y;
  msg.z_star_m = f.z_star_m;
  msg.reference_stamp_ns = f.reference_stamp_ns;
  return msg;
}

aras_visual_servo_msgs::TagFeatures toMessage(const TagFeatures& f) {
  aras_visual_servo_msgs::TagFeatures msg;
  msg.target_visible = f.target_visible;
  msg.has_reference = f.has_reference;
  msg.valid = f.valid;
  msg.fault = f.fault;
  msg.family = f.family;
  msg.id = f.id;
  msg.tags = f.tags;
  msg.side_px = f.side_px;
  msg.xg = f.xg;
  msg.yg = f.yg;
  msg.point_x = f.point_x;
  msg.point_y = f.point_y;
  msg.homography = f.homography;
  msg.position_m = f.position_m;
  msg.orientation = f.orientation;
  msg.pose_error = f.pose_error;
  msg.other_pose_error = f.other_pose_error;
  msg.z_star_m = f.z_star_m;
  msg.reference_stamp_ns = f.reference_stamp_ns;
  return msg;
}

}  // namespace aras_visual_servo_camera
