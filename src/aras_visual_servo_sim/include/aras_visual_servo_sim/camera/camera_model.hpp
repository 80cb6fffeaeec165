#pragma once

#include <Eigen/Core>
#include <aras_visual_servo_common/increasing_root.hpp>
#include <atomic>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "aras_visual_servo_sim/camera/camera_config.hpp"
#include "aras_visual_servo_sim/camera/equidistant_lens.hpp"
#include "aras_visual_servo_sim/config/section.hpp"
#include "aras_visual_servo_sim/config/types.hpp"
#include "aras_visual_servo_sim/image/image.hpp"

namespace aras_visual_servo_sim {

/** Rays within an angle, below 90 degrees, of an axis of unit length. */
struct RayCone {
  Eigen::Vector3d axis;
  double cosine, sine;  ///< of the angle
};

/** Geometry of a camera: pinhole with any principal point, and a lens.
 *
 *  Pixel (u, v) covers [u - 1/2, u + 1/2] x [v - 1/2, v + 1/2]; u grows to the right, v downwards, (0, 0) is the centre
 *  of the top left pixel. A point p_C = (X, Y, Z) with Z > 0 has normalised coordinates x = X/Z, y = Y/Z, the lens maps
 *  them to (xd, yd), and u = fx xd + cx, v = fy yd + cy. Through the equidistant lens Z may have any sign: (xd, yd) is
 *  (X, Y) scaled to the length that EquidistantLens gives for the angle from the axis. Lens formulas: OpenCV calib3d
 * and its fisheye namespace. */
class CameraModel {
 public:
  enum class Lens { kNone, kPlumbBob, kRational, kEquidistant };
  enum class Sampling { kCoverage, kCenter };

  /** @throws ParameterError listing every fault of config, among them a lens that folds over inside the image */
  explicit CameraModel(const CameraConfig& config);

  const CameraConfig& config() const { return config_; }
  int width() const { return config_.width; }
  int height() const { return config_.height; }
  double fx() const { return fx_; }
  double fy() const { return fy_; }
  double cx() const { return cx_; }
  double cy() const { return cy_; }
  double nearM() const { return config_.near_m; }
  double farM() const { return config_.far_m; }
  Lens lens() const { return lens_; }
  Sampling sampling() const { return sampling_; }
  Encoding encoding() const { return encoding_; }
  /** In which the renderer draws: rgb8 for a Bayer pattern, which is made of it, else encoding(). */
  Encoding drawnEncoding() const {
    if (encoding_ == Encoding::kMono16) return Encoding::kMono8;
    return isBayer(encoding_) || encoding_ == Encoding::kRgb16 ? Encoding::kRgb8 : encoding_;
  }
  /** A camera that sees row v of this one's image, and nothing else. */
  CameraModel row(int v) const;

  /** Pixel coordinates (u, v) of p_C [m]; nothing where Z <= 0 or beyond the radius at which the lens folds over.
   *  Through the equidistant lens: nothing beyond lensAngle(). The image border does not matter: coordinates may lie
   *  outside. */
  std::optional<Eigen::Vector2d> project(const Eigen::Vector3d& p_C) const;

  /** Ray through pixel coordinates (u, v), (x, y, 1), for the equidistant lens a unit vector: project(unproject(u, v))
   *  is (u, v) to 1e-12 of the image size.
   *  @throws NotFiniteError for NaN or infinity; ParameterError where no ray reaches (outside the lens's range) */
  Eigen::Vector3d unproject(double u, double v) const;

  /** Rays (as unproject's) through the corners of the pixels, (u - 1/2, v - 1/2) for u = 0 .. width, v = 0 .. height,
   *  row by row; beyond lensAngle() some ray or other. Made at the first call, shared by copies of this camera.
   *  Thread-safe. */
  const std::vector<Eigen::Vector3d>& cornerRays() const {
    if (!rays_->has_corners.load(std::memory_order_acquire)) makeCornerRays();  // asked for by every pixel
    return rays_->corners;
  }

  /** For each block of kBlock x kBlock pixels, row by row, a cone that holds every ray through it; blocks at the right
   *  and at the bottom may be narrower. Made and shared as cornerRays. */
  const std::vector<RayCone>& blockCones() const;
  static constexpr int kBlock = 8;  ///< [px]

  /** Ray (as unproject's) through the centre of a pixel. Through polynomial lenses the mean of those through its
   *  corners, which is the same to 1e-5 for lenses that bend by less than a pixel in ten. */
  Eigen::Vector3d pixelRay(int u, int v) const;

  /** Lens only: normalised (x, y) to distorted normalised (xd, yd), with no check of the range. */
  Eigen::Vector2d distort(double x, double y) const;

  /** As distort, in pixels, with no check: the inner loop of the renderer. */
  Eigen::Vector2d toPixel(double x, double y) const {
    if (lens_ == Lens::kNone) return {fx_ * x + cx_, fy_ * y + cy_};
    const Eigen::Vector2d d = distort(x, y);
    return {fx_ * d.x() + cx_, fy_ * d.y() + cy_};
  }
  /** The same for a ray in any direction but (0, 0, -1), of any length. @pre lens() is kEquidistant */
  Eigen::Vector2d toPixel(const Eigen::Vector3d& ray) const {
    const Eigen::Vector2d d = distort(ray);
    return {fx_ * d.x() + cx_, fy_ * d.y() + cy_};
  }

  /** Largest normalised radius of the image's border, pixel edges included. @pre lens() is not kEquidistant */
  double imageRadius() const { return image_radius_; }
  /** Equidistant lens: rays up to this angle from the axis are drawn [rad]. */
  double lensAngle() const { return fisheye_.reach(); }
  /** Equidistant lens: the largest angle from the axis of a ray that is drawn and meets the image [rad]. */
  double imageAngle() const { return image_angle_; }
  /** Whether some of the image lies beyond lensAngle() and is black. */
  bool showsLensCircle() const { return shows_lens_circle_; }
  /** Whether a pixel position lies within lensAngle(); true for the other lenses. */
  bool isWithinLens(double u, double v) const;

  /** Intrinsics as sensor_msgs/CameraInfo wants them: K 3 x 3, D (5, 8 or 4 numbers), R = I, P = [K p] with
   *  p = (-fx baseline_m, 0, 0). Those of config().told if there are any. */
  Eigen::Matrix3d K() const;
  const std::vector<double>& D() const { return config_.told ? config_.told->distortion : distortion_; }
  Eigen::Matrix3d R() const { return Eigen::Matrix3d::Identity(); }
  Eigen::Matrix<double, 3, 4> P() const;
  /** "plumb_bob", "rational_polynomial" or "equidistant"; "plumb_bob" with five zeros for no lens. */
  std::string distortionModel() const;

 private:
  void readLens(FaultList& faults);
  void readFocalLength(FaultList& faults);
  void checkSensor(FaultList& faults) const;
  Eigen::Vector2d distort(const Eigen::Vector3d& ray) const;
  aras_visual_servo_common::ValueAndSlope radial(double r) const;
  std::optional<double> inverseRadial(double rd) const;
  std::optional<Eigen::Vector2d> undistort(const Eigen::Vector2d& distorted) const;
  Eigen::Vector3d fisheyeRay(double u, double v) const;
  double lensRadiusOf(double u, double v) const;
  void findLensRadius();
  void findImageRadius(FaultList& faults);
  void findImageAngle(FaultList& faults);
  void makeCornerRays() const;

  CameraConfig config_;
  Lens lens_ = Lens::kNone;
  Sampling sampling_ = Sampling::kCoverage;
  Encoding encoding_ = Encoding::kRgb8;
  std::vector<double> distortion_;
  double fx_ = 0.0, fy_ = 0.0, cx_ = 0.0, cy_ = 0.0;
  double lens_radius_ = 0.0, image_radius_ = 0.0;  // normalised; not of the equidistant lens
  EquidistantLens fisheye_;
  double image_angle_ = 0.0;
  bool shows_lens_circle_ = false;
  struct Rays {
    std::atomic<bool> has_corners{false};
    std::once_flag corners_once, centers_once, cones_once;
    std::vector<RayCone> cones;
    std::vector<Eigen::Vector3d> corners, centers;
  };
  std::shared_ptr<Rays> rays_ = std::make_shared<Rays>();
};

}  // namespace aras_visual_servo_sim
