#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace aras_visual_servo_camera {

/** Features of one image: the fields of aras_visual_servo_msgs/MomentFeatures, which documents each of them.
 *  A quantity that does not exist in this image is NaN; then m and mu are empty. */
struct MomentFeatures {
  static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

  bool target_visible = false;
  bool touches_border = false;
  bool symmetric = false;
  bool has_reference = false;
  bool valid = false;
  bool ambiguous = false;
  int components = 0;
  double area = kNone;
  double xg = kNone, yg = kNone;
  double alpha = kNone;
  double xn = kNone, yn = kNone, an = kNone;
  double z_star_m = kNone;
  double area_star = kNone;
  std::int64_t reference_stamp_ns = -1;
  double orientation_condition = kNone;
  double asymmetry = kNone;
  double edge_stddev = kNone;
  std::vector<std::string> moment_names;
  std::vector<double> m;
  std::vector<double> mu;
  std::vector<double> point_x, point_y, point_z;
  std::string depth_fault;
  std::vector<double> ray_x, ray_y, ray_z;
  std::vector<double> kernel_x, kernel_y;
};

/** Third-order centred moments (mu30, mu21, mu12, mu03). */
using ThirdMoments = std::array<double, 4>;

/** The same in axes turned by `angle_rad` (x' along the direction `angle_rad` of the old axes). */
ThirdMoments rotated(const ThirdMoments& mu3, double angle_rad);

/** Inner product that does not change when both are rotated by the same angle: binomial weights 1, 3, 3, 1. */
double dot(const ThirdMoments& a, const ThirdMoments& b);

/** The view that the normalised features are relative to. */
struct Reference {
  double z_star_m;    ///< depth of the target, > 0 [m]
  double area_star;   ///< m00, > 0 [-]
  double alpha_star;  ///< [rad]
  /** Third-order centred moments in the axes of alpha_star, divided by their norm. Without them the first asymmetric
   *  view within 90 degrees of alpha_star supplies them. */
  std::optional<ThirdMoments> mu3_direction = std::nullopt;
  /** The reference view itself is symmetric, so that it cannot tell alpha from alpha + pi in any view. */
  bool symmetric = false;
};

/** Computes features from raw moments. Once there is a reference, they are relative to it.
 *
 *  Basic, centred and normalised moments are ViSP's (vpMomentBasic, ...GravityCenter, ...Centered, ...AreaNormalized,
 *  ...GravityCenterNormalized). Orientation is our own: vpMomentAlpha decides symmetry by an absolute threshold.
 *  alpha = atan2(2 mu11, mu20 - mu02) / 2 is known modulo pi; the branch is the one whose third-order moments, turned
 * by alpha, point the reference's way. A symmetric object takes the branch nearest to the last alpha, or the
 * reference's. */
class FeatureBuilder {
 public:
  FeatureBuilder(int order, double asymmetry_threshold, double orientation_threshold);
  ~FeatureBuilder();

  struct View {
    bool visible, touches_border;
    int components;
    bool ambiguous = false;
    int hard_area_px = 0;  ///< pixels of a hard-edged mask; 0: weights are area coverage
  };
  /** @param m  raw moments in the sequence of moments.hpp; not read unless view.visible. */
  MomentFeatures build(const View& view, const std::vector<double>& m);

  /** @throws ParameterError unless z_star_m and area_star are > 0 and everything is finite */
  void setReference(const Reference& reference);
  /** Take area, orientation and third-order moments from features of this order.
   *  @throws DegenerateFeature if they are not valid; ParameterError as above; ShapeError if mu has another length */
  void setReference(double z_star_m, const MomentFeatures& features);
  void clearReference();
  const std::optional<Reference>& reference() const { return reference_; }

  /** The next symmetric view is compared with the reference, not with the last view. */
  void forgetPrevious() { previous_alpha_.reset(); }

 private:
  /** @param noise  asymmetry that stairs of pixels may make. @param symmetric  in: too little asymmetry; out: also set
   * where the reference cannot tell the branch */
  double resolveAlpha(double alpha, const ThirdMoments& mu3, double asymmetry, double noise, bool* symmetric);

  struct VispMoments;
  std::unique_ptr<VispMoments> visp_;
  double asymmetry_threshold_, orientation_threshold_;
  std::vector<std::string> names_;
  std::optional<Reference> reference_;
  std::optional<double> previous_alpha_;
};

/** Does the same with each field of MomentFeatures, which its message and its Python class have too. */
// clang-format off
#define ARAS_MOMENT_FIELDS(DO) \
  DO(target_visible) DO(touches_border) DO(symmetric) DO(has_reference) DO(valid) DO(ambiguous) \
  DO(components) DO(area) DO(xg) DO(yg) DO(alpha) DO(xn) DO(yn) DO(an) DO(z_star_m) DO(area_star) \
  DO(reference_stamp_ns) DO(orientation_condition) DO(asymmetry) DO(edge_stddev) DO(moment_names) DO(m) DO(mu) \
  DO(point_x) DO(point_y) DO(point_z) DO(depth_fault) DO(ray_x) DO(ray_y) DO(ray_z) DO(kernel_x) DO(kernel_y)
// clang-format on

}  // namespace aras_visual_servo_camera
