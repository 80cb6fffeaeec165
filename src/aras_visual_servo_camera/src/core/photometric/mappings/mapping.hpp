#pragma once

#include <memory>
#include <opencv2/core.hpp>
#include <utility>
#include <vector>

#include "aras_visual_servo_camera/config/vision_config.hpp"
#include "aras_visual_servo_camera/image/camera_intrinsics.hpp"
#include "aras_visual_servo_camera/photometric/photometric_extractor.hpp"
#include "photometric/normal_equations.hpp"

namespace aras_visual_servo_camera {

/** The pixels of one level as a mapping is given them: images of single precision, all of one size, the rim cut off,
 *  zero where no ray reaches the pixel. */
struct MappedPixels {
  std::vector<cv::Mat> columns;  ///< six of L, then those that explain the illumination, then e = I - I*
  cv::Mat image, reference;      ///< I and I*, smoothed [grey levels]
  cv::Mat mask;                  ///< 1 where a ray reaches the pixel, else 0
};

/** Where the pixels of a level look: what it takes to draw the reference as another camera would see it. */
struct LevelView {
  CameraIntrinsics intrinsics;
  Plane plane;
  double pitch;  ///< pixels of the image to one of this level
  int border;    ///< of the pixels that were cut off
};

/** What takes the place of the grey levels themselves: features that are made of all pixels of one level.
 *
 *  A mapping turns the interaction matrix of the pixels into that of its features. It keeps what it learnt from the
 *  reference and nothing of other images; same images, same bits. */
class PhotometricMapping {
 public:
  virtual ~PhotometricMapping() = default;

  /** Stages from fine (0) to coarse that a level has, each with features of its own. */
  virtual int stages() const { return 1; }

  /** Pixels that are as much to this stage as one pixel is to the image: `switch_px` counts in them. */
  virtual double pitch(int /*stage*/) const { return 1.0; }

  /** @param pixels  of the reference; its e is zero
   *  @throws ParameterError if the level is too small for the settings */
  virtual void setReference(const MappedPixels& pixels, const LevelView& view) = 0;

  /** H = L^T L and b = L^T e of the features of a stage, or what takes their place in a step of Newton. */
  virtual NormalEquations equations(const MappedPixels& pixels, int stage) const = 0;
};

/** A mapping whose features are sums over the pixels with fixed weights, s = A I: then L_s = A L_I (T80). */
class LinearMapping : public PhotometricMapping {
 public:
  NormalEquations equations(const MappedPixels& pixels, int stage) const override;

  /** A times an image, added up in a fixed order. */
  virtual std::vector<double> project(const cv::Mat& image, int stage) const = 0;
};

/** The mapping of the configuration; null for `none`. */
std::unique_ptr<PhotometricMapping> makeMapping(const PhotometricConfig& config);

// One per file; makeMapping() knows them by these.
std::unique_ptr<PhotometricMapping> makeDct(const DctConfig& config);
std::unique_ptr<PhotometricMapping> makeMixture(const MixtureConfig& config);
std::unique_ptr<PhotometricMapping> makePca(const PcaConfig& config);
std::unique_ptr<PhotometricMapping> makeMutualInformation(const MutualInformationConfig& config);

/** Weights of a row or column of pixels, the first of them at pixel `first`; beyond them they are zero. */
struct Window {
  int first;
  std::vector<float> weights;
};

/** Sums over an image whose weights are a product of one along the columns and one along the rows. */
class SeparableSums {
 public:
  SeparableSums() = default;
  /** @param along_u, along_v  windows within the image
   *  @param kept  pairs (index in along_u, index in along_v) of the sums that are wanted, in their order */
  SeparableSums(std::vector<Window> along_u, std::vector<Window> along_v, std::vector<std::pair<int, int>> kept);

  /** Of an image of single precision. Same image, same bits. */
  std::vector<double> of(const cv::Mat& image) const;

 private:
  std::vector<Window> along_u_, along_v_;
  std::vector<std::pair<int, int>> kept_;
};

}  // namespace aras_visual_servo_camera
