// Models that come one at a time.
#include <aras_visual_servo_common/files.hpp>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "aras_visual_servo_sim/scene/scene_config.hpp"

namespace aras_visual_servo_sim {
namespace {

bool endsWith(const std::string& text, const std::string& suffix) {
  return text.size() >= suffix.size() && text.compare(text.size() - suffix.size(), suffix.size(), suffix) == 0;
}

}  // namespace

SceneEntry sceneEntryFromYaml(const YAML::Node& node) {
  bool solid = false;
  for (const char* key : {"box_m", "cylinder_m", "cone_m", "sphere_m", "mesh", "urdf"}) {
    solid = solid || (node.IsMap() && node[key].IsDefined());
  }
  YAML::Node scene;
  scene[solid ? "solids" : "models"].push_back(node);
  SceneConfig config = SceneConfig::fromYaml(scene);
  if (solid) return std::move(config.solids.front());
  return std::move(config.models.front());
}

const std::string& nameOf(const SceneEntry& entry) {
  return std::visit([](const auto& each) -> const std::string& { return each.name; }, entry);
}

YAML::Node modelEntry(const std::string& name, const std::string& description) {
  const std::size_t first = description.find_first_not_of(" \t\r\n");
  if (first == std::string::npos) {
    throw ParameterError("model '" + name + "': found an empty description, allowed a URDF, a file name or YAML");
  }
  YAML::Node entry;
  const bool one_line = description.find('\n') == std::string::npos && description[first] != '{';
  if (description[first] == '<' || (one_line && endsWith(description, ".urdf"))) {
    entry["urdf"] = description;
  } else if (one_line && (endsWith(description, ".yaml") || endsWith(description, ".yml"))) {
    entry["file"] = description;
  } else if (one_line && description.find(':') == description.find("://")) {
    entry["mesh"] = description;
  } else {
    try {
      entry = aras_visual_servo_common::parseYaml(description, aras_visual_servo_common::kMostSentYaml);
    } catch (const ArasError& error) {
      throw ParameterError("model '" + name + "': " + error.what());
    }
    if (!entry.IsMap()) {
      throw ParameterError("model '" + name + "': found '" + description + "', allowed a URDF, a file name or YAML");
    }
  }
  entry["name"] = name;
  return entry;
}

}  // namespace aras_visual_servo_sim
