#include "aras_visual_servo_camera/config/matching_config.hpp"

#include <string>

#include "config/read_depth.hpp"
#include "config/read_matching.hpp"
#include "schema_sections.hpp"

namespace aras_visual_servo_camera {

using aras_visual_servo_common::YamlReader;

MatchingConfig readMatching(YamlReader reader) {
  MatchingConfig c{};
  c.detector = reader.choice<KeypointDetector>(
      "detector",
      {{"orb", KeypointDetector::kOrb}, {"akaze", KeypointDetector::kAkaze}, {"sift", KeypointDetector::kSift}});
  c.keypoints = reader.get<int>("keypoints");
  c.ratio = reader.get<double>("ratio");
  c.inlier_px = reader.get<double>("inlier_px");
  c.min_matches = reader.get<int>("min_matches");
  c.iterations = reader.get<int>("iterations");
  c.seed = reader.get<int>("seed");
  if (reader.has("depth")) c.depth = readDepth(reader.section("depth"));
  if (c.keypoints < c.min_matches)
    reader.fault("keypoints", std::to_string(c.keypoints), ">= min_matches, " + std::to_string(c.min_matches));
  return c;
}

MatchingConfig readMatchingConfig(const YAML::Node& node) {
  YamlReader reader(node, schemaSections().section("matches"), "vision/matches");
  const MatchingConfig config = readMatching(reader);
  reader.finish();
  return config;
}

}  // namespace aras_visual_servo_camera
