#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

namespace aras_visual_servo_camera {

/** Photometric features of one image: the fields of aras_visual_servo_msgs/PhotometricFeatures, which documents each of
 *  them. A quantity that does not exist in this image is NaN; then H and b are empty. */
struct PhotometricFeatures {
  static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

  bool target_visible = false;
  bool has_reference = false;
  bool valid = false;
  std::string fault;
  std::string interaction;
  int level = 0;
  int levels = 1;
  int pixels = 0;
  double rms = kNone;
  double cost = kNone;
  std::vector<double> H;
  std::vector<double> b;
  double condition = kNone;
  double motion_px = kNone;
  double z_star_m = kNone;
  std::uint64_t reference_hash = 0;
  std::int64_t reference_stamp_ns = -1;
};

/** Index of H_ij, i <= j, in PhotometricFeatures::H: the upper triangle, row by row. */
constexpr int upperIndex(int i, int j) { return i * 6 - i * (i - 1) / 2 + (j - i); }

/** Does the same with each field of PhotometricFeatures, which its message and its Python class have too. */
// clang-format off
#define ARAS_PHOTOMETRIC_FIELDS(DO) \
  DO(target_visible) DO(has_reference) DO(valid) DO(fault) DO(interaction) DO(level) DO(levels) DO(pixels) \
  DO(rms) DO(cost) DO(H) DO(b) DO(condition) DO(motion_px) DO(z_star_m) DO(reference_hash) \
  DO(reference_stamp_ns)
// clang-format on

}  // namespace aras_visual_servo_camera
