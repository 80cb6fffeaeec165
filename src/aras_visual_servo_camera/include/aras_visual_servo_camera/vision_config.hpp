#pragma once

#include <optional>

#include "aras_visual_servo_camera/photometric_config.hpp"

namespace YAML {
class Node;
}

namespace aras_visual_servo_camera {

enum class ObjectShade { kDark, kBright };
enum class SegmentationMethod { kFixed, kOtsu, kAdaptive, kCoverage };
enum class ComponentChoice { kLargest, kNearestToPrevious, kMostSimilar };
enum class PointSource { kNone, kCorners, kBlobs };

/** The `vision` section of a scenario. Greys and thresholds are 8-bit levels, 0 to 255. */
struct VisionConfig {
  ObjectShade object = ObjectShade::kDark;
  SegmentationMethod segmentation = SegmentationMethod::kCoverage;
  /** kFixed: a dark object is grey < threshold, a bright one grey > threshold. */
  double threshold = 128.0;
  /** kCoverage: the levels of a pixel inside and outside the object; estimated from each image when not given. */
  std::optional<double> object_grey;
  std::optional<double> background_grey;
  /** kOtsu, and kCoverage with an estimated level: less contrast than this is an image without an object. */
  double min_contrast = 25.0;
  /** kAdaptive: side of the (odd) square whose mean is the local background, larger than the object, and how many
   *  levels the object must differ from that mean. */
  int adaptive_block_px = 101;
  double adaptive_offset = 20.0;
  ComponentChoice component = ComponentChoice::kLargest;
  /** Components of fewer pixels are specks: not counted, not chosen. */
  int min_area_px = 50;
  /** The object followed stays visible until it is smaller than this; not given: min_area_px. */
  std::optional<int> lost_area_px;
  /** An object cut by the border counts as cut until it is this many pixels clear of it. */
  int border_margin_px = 0;
  /** How many times better an object must be (larger, nearer, more similar) to be told from the next, >= 1 ... */
  double switch_ratio = 1.2;
  /** ... and in how many images, one after another, to take the place of the one followed. */
  int switch_images = 5;
  /** Highest order i + j of the moments. */
  int order = 3;
  /** Below this MomentFeatures::asymmetry the orientation is known modulo pi only. */
  double asymmetry_threshold = 0.03;
  /** Below this MomentFeatures::orientation_condition the object counts as round: alpha is NaN. */
  double orientation_threshold = 0.01;
  /** Points to follow: corners of the chosen object's outline, or centroids of several objects. */
  PointSource points = PointSource::kNone;
  /** How many: corners of the outline (3 or more), or objects. */
  int point_count = 4;
  /** Projections of the object onto the kernels X^-p and Y^-q; nothing of it is computed when absent. */
  struct Kernel {
    double p = 1.0, q = 1.0;  ///< exponents, > 0
  };
  std::optional<Kernel> kernel;
  /** Luminance of the whole image as the feature, beside the moments; nothing of it is computed when absent. */
  std::optional<PhotometricConfig> photometric;
};

/** @param node  mapping with keys `object` and `segmentation` (required), `threshold` (required by `fixed`), and the
 *      other members of VisionConfig by name
 *  @throws ParameterError listing every unknown, missing, mistyped or out-of-range key */
VisionConfig readVisionConfig(const YAML::Node& node);

}  // namespace aras_visual_servo_camera
