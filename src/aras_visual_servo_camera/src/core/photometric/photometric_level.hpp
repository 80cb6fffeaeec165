#pragma once

#include <array>
#include <opencv2/core.hpp>
#include <vector>

#include "aras_visual_servo_camera/config/photometric_config.hpp"
#include "aras_visual_servo_camera/image/camera_intrinsics.hpp"
#include "aras_visual_servo_camera/photometric/photometric_extractor.hpp"

namespace aras_visual_servo_camera {

using Vector6 = std::array<double, 6>;

/** H = L^T L and b = L^T e of one image, after the changes that the illumination explains have been removed. */
struct NormalEquations {
  cv::Matx66d H;
  Vector6 b{};
  double cost = 0.0;  ///< e^T e / 2, grey levels squared
};

/** Solution of H step = -b. */
struct GaussNewton {
  bool solvable = false;   ///< six motions are told apart
  double condition = 0.0;  ///< of L, its columns scaled to length 1; infinite if it is singular
  Vector6 step{};          ///< -H^-1 b [m, rad]
};

/** @param smallest  a column of L shorter than this, per pixel, tells nothing [grey levels per m, rad] */
GaussNewton solve(const NormalEquations& equations, int pixels, double smallest);

/** One level of the pyramid: its pixels' rays, the reference, and the sums over the pixels.
 *
 *  Pixel (u, v) of level k lies at (2^k u, 2^k v) of the image. Sums are of single precision along a row, in a fixed
 * order, and of double precision over the rows. */
class PhotometricLevel {
 public:
  /** @throws ParameterError if nothing is left inside the border */
  PhotometricLevel(const CameraIntrinsics& intrinsics, int level, const PhotometricConfig& config);

  /** @throws ParameterError unless the plane lies in front of every pixel that is used */
  void setPlane(const Plane& plane);

  /** @param image  CV_32F of this level, here and below */
  void setReference(const cv::Mat& image);

  /** L^T L of the reference alone; b and cost are 0. */
  NormalEquations ofReference();

  NormalEquations process(const cv::Mat& image);

  /** Rms motion of the image that a step of the camera makes, in pixels of this level. */
  double motion(const Vector6& step) const;

  /** Pixels inside the border that a ray reaches. */
  int pixels() const { return pixels_; }

  /** Rms of a - b over these pixels, without the part that the illumination explains [grey levels]. */
  double rms(const cv::Mat& a, const cv::Mat& b) const;

 private:
  struct Gradient {
    cv::Mat x, y;  ///< d/dx, d/dy in normalised coordinates, CV_32F
  };
  void smooth(const cv::Mat& image, cv::Mat* out) const;
  void differentiate(const cv::Mat& image, Gradient* out);
  NormalEquations sum(const Gradient& gradient, const cv::Mat* image);

  PhotometricConfig config_;
  int width_, height_, border_, pixels_ = 0;
  double scale_;          ///< focal length, geometric mean, in pixels of this level
  cv::Mat x_, y_, mask_;  ///< ray of each pixel, CV_32F; mask: 1 where there is one and inside the border, else 0
  cv::Mat zeta_;          ///< 1/Z of each pixel
  std::array<cv::Mat, 4> duv_dxy_;  ///< du/dx, du/dy, dv/dx, dv/dy; empty without distortion
  std::array<double, 2> focal_;     ///< du/dx, dv/dy without distortion
  cv::Mat gauss_, derivative_;      ///< kernels
  cv::Matx66d flow_;                ///< mean of L_x^T L_x over the pixels
  cv::Mat reference_, smoothed_, du_, dv_;
  Gradient reference_gradient_, gradient_;
  std::vector<float> columns_;  ///< of one row of pixels: L, illumination, e, one after the other
};

}  // namespace aras_visual_servo_camera
