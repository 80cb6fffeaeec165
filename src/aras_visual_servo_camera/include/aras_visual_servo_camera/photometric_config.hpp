#pragma once

#include <array>

namespace YAML {
class Node;
}

namespace aras_visual_servo_camera {

/** Which image the gradient in the interaction matrix is of: the reference, the current one, or the mean of both. */
enum class GradientOf { kDesired, kCurrent, kMean };

/** What may differ between two images of the same view: nothing, an offset of the grey levels, or gain and offset. */
enum class Illumination { kConstant, kOffset, kGainAndOffset };

/** The section `vision.photometric` of a scenario. Greys are 8-bit levels, 0 to 255. */
struct PhotometricConfig {
  GradientOf interaction = GradientOf::kMean;
  Illumination illumination = Illumination::kConstant;
  /** Levels of the Gaussian pyramid, each half as wide as the one before; 1: the image alone. */
  int levels = 1;
  /** A level is left for the next finer one once the step that it asks for moves the image by less than this, rms, in
   *  its own pixels. */
  double switch_px = 0.5;
  /** Standard deviation of the Gaussian that smooths images and gradients, in pixels of the level. */
  double smoothing_px = 1.0;
  /** Rim of the image that is left out, at least the reach of the smoothing. */
  int border_px = 10;
  /** An image whose grey levels have a smaller standard deviation shows nothing. */
  double min_contrast = 3.0;
  /** Normal of the target's plane in the camera frame at the goal, z > 0, any length. */
  std::array<double, 3> target_normal_C{0.0, 0.0, 1.0};
};

/** @param node  mapping with the members of PhotometricConfig by name: `interaction` desired | current | mean,
 *      `illumination` constant | offset | gain_and_offset, ...; all optional
 *  @throws ParameterError listing every unknown, mistyped or out-of-range key */
PhotometricConfig readPhotometricConfig(const YAML::Node& node);

}  // namespace aras_visual_servo_camera
