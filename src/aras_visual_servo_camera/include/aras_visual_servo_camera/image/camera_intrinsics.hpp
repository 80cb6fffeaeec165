#pragma once

#include <aras_visual_servo_common/increasing_root.hpp>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

namespace YAML {
class Node;
}

namespace aras_visual_servo_camera {

struct CameraInfoConfig;

/** Pinhole camera with a lens, as sensor_msgs/CameraInfo describes it.
 *
 *  Pixel (u, v) covers [u - 1/2, u + 1/2] x [v - 1/2, v + 1/2]: the centre of a w-pixel row is u = (w - 1) / 2.
 *  Normalised coordinates: x = X/Z to the right, y = Y/Z down, frame C (optical). Immutable once built. */
class CameraIntrinsics {
 public:
  /** Largest angle of a ray from the optical axis, 80 degrees [rad]: x = X/Z is 5.7 there and infinite at 90 degrees. A
   * fisheye may see farther, but pixels beyond this angle have no coordinates (Undistorted::valid is false), and an
   * object that reaches there has no features. */
  static constexpr double kWidestAngle = 80.0 * 3.14159265358979323846 / 180.0;

  /** Largest angle of a ray on the unit sphere, 100 degrees [rad]: a view 200 degrees wide. */
  static constexpr double kWidestRay = 100.0 * 3.14159265358979323846 / 180.0;

  /** @param K  row-major 3 x 3 [px]: fx, 0, cx, 0, fy, cy, 0, 0, 1; cx, cy may lie outside the image
   *  @param distortion_model  "" or "none" (D empty or zero), "plumb_bob" (k1 k2 p1 p2 [k3]),
   *      "rational_polynomial" (k1 k2 p1 p2 k3 k4 k5 k6) or "equidistant" (k1 k2 k3 k4)
   *  @throws ParameterError listing every fault: no size, K zero, the identity or not finite, a focal length that no
   * lens has at this size, skew, unknown model, wrong length of D */
  CameraIntrinsics(int width_px, int height_px, const std::array<double, 9>& K, const std::string& distortion_model,
                   const std::vector<double>& D);

  int width() const { return width_; }
  int height() const { return height_; }
  double fx() const { return fx_; }
  double fy() const { return fy_; }
  double cx() const { return cx_; }
  double cy() const { return cy_; }
  /** False when the lens is ideal: x depends on u alone and y on v alone. */
  bool distorted() const { return lens_ != Lens::kNone; }
  bool operator==(const CameraIntrinsics& other) const;

  struct Undistorted {
    double x = 0.0, y = 0.0;  ///< normalised coordinates [-]
    /** d(x, y)/d(u, v) [1/px], row-major. */
    std::array<double, 4> jacobian{};
    bool valid = false;  ///< false: no ray reaches this pixel, or one beyond the fold or kWidestAngle
  };

  /** The ray of a pixel position; Newton's method on the lens model, to rounding. */
  Undistorted undistort(double u_px, double v_px) const;

  /** A unit vector, z along the optical axis. */
  struct Ray {
    double x = 0.0, y = 0.0, z = 1.0;
    double solid_angle = 0.0;  ///< that a pixel there covers [sr]; 0: there is no ray
  };

  /** The ray of a pixel position: through a fisheye as far as kWidestRay, else
   * where undistort() has one. */
  Ray rayOf(double u_px, double v_px) const;

  /** Pixel position of the ray (x, y, 1): the lens model itself. Beyond the fold it lies among the pixels of other
   * rays, see isWithinFold(). */
  std::array<double, 2> project(double x, double y) const;

  /** Whether the ray (x, y, 1) is nearer to the optical axis than those at which the lens model folds. */
  bool isWithinFold(double x, double y) const { return std::hypot(x, y) <= fold_; }

  /** Distance from the optical axis [px] from which on the lens model is not one-to-one: pixels there stand for two
   * rays or none, and have no coordinates. Infinite where this is nowhere in the image. */
  double foldRadius() const;

  /** Returns what a user must know of the fold, in one sentence; empty where there is none in the image. */
  std::string foldWarning() const;

 private:
  friend CameraIntrinsics intrinsicsOf(const CameraInfoConfig& info);
  enum class Lens { kNone, kPolynomial, kEquidistant };

  /** Distorted coordinates and their Jacobian d(xd, yd)/d(x, y), row-major. */
  void distort(double x, double y, double xd[2], double J[4]) const;
  void distortPolynomial(double x, double y, double xd[2], double J[4]) const;
  void distortEquidistant(double x, double y, double xd[2], double J[4]) const;
  aras_visual_servo_common::ValueAndSlope drawn(double theta) const;
  aras_visual_servo_common::ValueAndSlope drawnByPolynomial(double r) const;
  void findReach();
  void findFold();
  double angleOf(double rd) const;
  Undistorted solve(double xd, double yd, Undistorted from) const;
  double farthestCorner() const;

  int width_, height_;
  double fx_ = 0.0, fy_ = 0.0, cx_ = 0.0, cy_ = 0.0;
  Lens lens_ = Lens::kNone;
  std::array<double, 8> D_{};
  double reach_ = 0.0;  // of the equidistant lens [rad]
  // Distances from the axis, of the ray and as the lens draws it, where the polynomial lens folds; infinite: nowhere.
  double fold_ = std::numeric_limits<double>::infinity(), drawn_fold_ = std::numeric_limits<double>::infinity();
};

/** Returns the intrinsics of the images: K is that of the whole sensor, so it is cropped to the region of interest and
 *  then binned, the centre of a pixel of the image being that of the pixels it is made of.
 *  @throws ParameterError listing every fault: those of the constructor, a region outside the sensor, a binned or
 * cropped K whose optical axis lies beside the sensor */
CameraIntrinsics intrinsicsOf(const CameraInfoConfig& info);

/** @param node  mapping with width, height, K (9), D, distortion_model and, where used, binning_x, binning_y and roi;
 * P, R, frame_id and header are accepted and not used
 *  @throws ParameterError listing every fault */
CameraIntrinsics readCameraInfo(const YAML::Node& node);

}  // namespace aras_visual_servo_camera
