#include "aras_visual_servo_common/yaml_scalars.hpp"

#include <array>
#include <charconv>
#include <cmath>

namespace aras_visual_servo_common {

YAML::Node quotedText(const std::string& text) {
  YAML::Node node(text);
  node.SetTag("!");  // what yaml-cpp gives a quoted scalar
  return node;
}

YAML::Node exactNumber(double value) {
  if (std::isnan(value)) return YAML::Node(".nan");
  if (std::isinf(value)) return YAML::Node(value > 0.0 ? ".inf" : "-.inf");
  std::array<char, 32> text;  // the shortest that reads back as the same number has 24 characters at most
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value).ptr;
  return YAML::Node(std::string(text.data(), end));
}

}  // namespace aras_visual_servo_common
