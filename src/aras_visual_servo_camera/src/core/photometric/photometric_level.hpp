#pragma once

#include <array>
#include <memory>
#include <opencv2/core.hpp>
#include <vector>

#include "aras_visual_servo_camera/config/vision_config.hpp"
#include "aras_visual_servo_camera/image/camera_intrinsics.hpp"
#include "aras_visual_servo_camera/photometric/photometric_extractor.hpp"
#include "photometric/mappings/mapping.hpp"
#include "photometric/normal_equations.hpp"

namespace aras_visual_servo_camera {

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

  /** H of the reference alone; b and cost are 0. */
  NormalEquations ofReference();

  /** Take an image, which equations() are of from then on. */
  void look(const cv::Mat& image);

  /** Of the grey levels, or of the features of the mapping at one of its stages. */
  NormalEquations equations(int stage);

  /** Stages of the mapping from fine (0) to coarse; 1 without one. */
  int stages() const { return mapping_ ? mapping_->stages() : 1; }

  /** Rms motion of the image that a step of the camera makes, in pixels of this level, and there of this stage. */
  double motion(const Vector6& step, int stage) const;

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
  /** L, what explains the illumination, and e of one row of pixels; `column` points to 7 to 9 rows. */
  void fillRow(int v, const Gradient& gradient, const cv::Mat& image, float* const* column) const;
  NormalEquations sum(const Gradient& gradient, const cv::Mat& image);
  void map(const Gradient& gradient, const cv::Mat& image);
  const Gradient& gradientOfLook() const;

  PhotometricConfig config_;
  std::unique_ptr<PhotometricMapping> mapping_;  ///< null: the grey levels themselves
  LevelView view_;
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
  MappedPixels mapped_;         ///< with a mapping
};

}  // namespace aras_visual_servo_camera
