#pragma once

#include <optional>
#include <string>

namespace YAML {
class Node;
}

namespace aras_visual_servo_camera {

/** The section `vision.tag` of a scenario. What each key means, its range and its default stand in schema/tag.yaml, by
 *  the names of these members; one made by readTagConfig() has them all. */
struct TagConfig {
  std::string family;
  int id{};
  std::optional<double> size_m;
  double min_side_px{};
};

/** @param node  a map as schema/tag.yaml describes it
 *  @throws ParameterError listing every unknown, mistyped or out-of-range key */
TagConfig readTagConfig(const YAML::Node& node);

}  // namespace aras_visual_servo_camera
