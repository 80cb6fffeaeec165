#include "aras_visual_servo_camera/config/tag_config.hpp"

#include "config/read_tag.hpp"
#include "schema_sections.hpp"

namespace aras_visual_servo_camera {

using aras_visual_servo_common::YamlReader;

TagConfig readTag(YamlReader reader) {
  TagConfig config;
  config.family = reader.get<std::string>("family");
  config.id = reader.get<int>("id");
  config.size_m = reader.find<double>("size_m");
  config.min_side_px = reader.get<double>("min_side_px");
  return config;
}

TagConfig readTagConfig(const YAML::Node& node) {
  YamlReader reader(node, schemaSections().section("tag"), "vision/tag");
  const TagConfig config = readTag(reader);
  reader.finish();
  return config;
}

}  // namespace aras_visual_servo_camera
