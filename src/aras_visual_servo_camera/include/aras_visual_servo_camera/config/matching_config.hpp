#pragma once

#include <optional>

#include "aras_visual_servo_camera/config/depth_config.hpp"

namespace YAML {
class Node;
}

namespace aras_visual_servo_camera {

enum class KeypointDetector { kOrb, kAkaze, kSift };

/** The section `vision.matches` of a scenario. What each key means, its range and its default stand in
 *  schema/matches.yaml, by the names of these members; one made by readMatchingConfig() has them all. */
struct MatchingConfig {
  KeypointDetector detector{};
  int keypoints{};
  double ratio{};
  double inlier_px{};
  int min_matches{};
  int iterations{};
  int seed{};
  std::optional<DepthConfig> depth;
};

/** @param node  a map as schema/matches.yaml describes it
 *  @throws ParameterError listing every unknown, mistyped or out-of-range key */
MatchingConfig readMatchingConfig(const YAML::Node& node);

}  // namespace aras_visual_servo_camera
