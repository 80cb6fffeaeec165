#pragma once

#include <optional>

#include "aras_visual_servo_camera/config/depth_config.hpp"
#include "aras_visual_servo_camera/config/matching_config.hpp"
#include "aras_visual_servo_camera/config/photometric_config.hpp"
#include "aras_visual_servo_camera/config/tag_config.hpp"

namespace YAML {
class Node;
}

namespace aras_visual_servo_camera {

enum class ObjectShade { kDark, kBright };
enum class SegmentationMethod { kFixed, kOtsu, kAdaptive, kCoverage };
enum class ComponentChoice { kLargest, kNearestToPrevious, kMostSimilar };
enum class PointSource { kNone, kCorners, kBlobs };

/** The section `vision` of a scenario. What each key means, its range and its default stand in schema/vision.yaml, by
 * the names of these members; one made by readVisionConfig() has them all. */
struct VisionConfig {
  ObjectShade object{};
  SegmentationMethod segmentation{};
  double threshold{};  ///< kFixed: a dark object is grey < threshold, a bright one grey > threshold
  std::optional<double> object_grey, background_grey;
  double min_contrast{};
  int adaptive_block_px{};
  double adaptive_offset{};
  ComponentChoice component{};
  int min_area_px{};
  std::optional<int> lost_area_px;
  int border_margin_px{};
  double switch_ratio{};
  int switch_images{};
  int order{};
  double asymmetry_threshold{};    ///< of MomentFeatures::asymmetry
  double orientation_threshold{};  ///< of MomentFeatures::orientation_condition
  PointSource points{};
  int point_count{};
  bool rays{};
  struct Kernel {
    double p, q;
  };
  std::optional<Kernel> kernel;
  std::optional<DepthConfig> depth;
  std::optional<PhotometricConfig> photometric;
  std::optional<MatchingConfig> matches;
  std::optional<TagConfig> tag;
};

/** @param node  a map as schema/vision.yaml describes it
 *  @throws ParameterError listing every unknown, missing, mistyped or out-of-range key */
VisionConfig readVisionConfig(const YAML::Node& node);

}  // namespace aras_visual_servo_camera
