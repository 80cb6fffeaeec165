#include "aras_visual_servo_sim/scene/scene_config.hpp"

#include <algorithm>
#include <aras_visual_servo_common/files.hpp>
#include <cmath>
#include <set>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "aras_visual_servo_sim/config/section.hpp"
#include "scene_settings.hpp"

namespace aras_visual_servo_sim {
namespace {

/** The one shape of a solid; the section sees to it that it has one. */
Geometry geometryOf(const SolidConfig& solid) {
  Geometry geometry;
  const auto round = [&geometry](Geometry::Type type, const Eigen::Vector2d& size) {
    geometry.type = type;
    geometry.radius_m = size[0];
    geometry.length_m = size[1];
  };
  if (solid.box_m) geometry.size_m = *solid.box_m;
  if (solid.cylinder_m) round(Geometry::Type::kCylinder, *solid.cylinder_m);
  if (solid.cone_m) {
    round(Geometry::Type::kCone, *solid.cone_m);
    geometry.size_m = {2.0 * geometry.radius_m, 2.0 * geometry.radius_m, geometry.length_m};
  }
  if (solid.sphere_m) {
    geometry.type = Geometry::Type::kSphere;
    geometry.radius_m = *solid.sphere_m;
  }
  if (solid.mesh) {
    geometry.type = Geometry::Type::kMesh;
    geometry.filename = *solid.mesh;
    geometry.scale = solid.scale;
  }
  return geometry;
}

std::optional<ModelMotion> motionOf(const std::optional<MotionConfig>& settings, const SectionCheck& section) {
  if (!settings) return std::nullopt;
  checkMotion(*settings, section.part("motion"));
  return ModelMotion(*settings, section.node("motion"));
}

ModelEntry modelOf(const ModelConfig& settings, const SectionCheck& section) {
  ModelEntry entry;
  entry.name = settings.name;
  entry.file = settings.file.value_or("");
  entry.X_WM = poseOf(settings);
  entry.visible = settings.visible;
  entry.carrier = settings.attached_to.value_or("");
  entry.motion = motionOf(settings.motion, section);
  if (entry.motion && !entry.carrier.empty())
    section.fault("motion", "it together with attached_to", "one of the two, because the link moves the model");
  entry.shape = planarShapeOf(settings);
  for (const char* key : {"color_rgb", "outlines_m", "image", "board"}) {
    if (settings.file && section.has(key))
      section.fault(key, "it together with file", "one of the two, because the file holds the shape");
  }
  return entry;
}

/** A name, or a list of names. */
std::vector<std::string> namesOf(const YAML::Node& touches) {
  if (touches.IsScalar()) return {touches.Scalar()};
  std::vector<std::string> names;
  for (const auto& name : touches) names.push_back(name.IsScalar() ? name.Scalar() : "");
  return names;
}

SolidEntry solidOf(const SolidConfig& settings, const SectionCheck& section) {
  if (settings.mass_kg && settings.urdf)
    section.fault("mass_kg", "it together with urdf", "it with box_m, cylinder_m, cone_m, sphere_m or mesh only");
  if (section.has("scale") && !settings.mesh) section.fault("scale", "it without mesh", "it with mesh only");
  return {settings.name,
          settings.urdf.value_or(""),
          geometryOf(settings),
          colorOf(settings.color_rgb),
          materialOf(settings.material),
          settings.material.casts_shadows,
          poseOf(settings),
          motionOf(settings.motion, section),
          settings.mass_kg.value_or(0.0),
          namesOf(settings.touches)};
}

/** Two of one name are a fault; that a name is missing was said already. */
template <typename Entry>
void requireDistinct(const std::vector<Entry>& entries, const char* key, const SectionCheck& section) {
  std::set<std::string> names;
  for (const Entry& entry : entries) {
    if (!entry.name.empty() && !names.insert(entry.name).second)
      section.fault(key, "two named '" + entry.name + "'", "distinct names");
  }
}

bool endsWith(const std::string& text, const std::string& suffix) {
  return text.size() >= suffix.size() && text.compare(text.size() - suffix.size(), suffix.size(), suffix) == 0;
}

}  // namespace

SceneConfig::SceneConfig(const SceneKeys& settings, const SectionCheck& section)
    : background(colorOf(settings.background_rgb)),
      light_direction_W(settings.light_direction),
      lighting(lightingOf(settings.lighting)),
      has_lights(section.part("lighting").has("lights")),
      has_background(section.has("background_rgb")) {
  if (light_direction_W.norm() == 0.0) section.fault("light_direction", "zero", "any other direction");
  const SectionCheck lights = section.part("lighting");
  for (std::size_t k = 0; k < settings.lighting.lights.size(); ++k)
    checkLight(settings.lighting.lights[k], lights.part("lights", k));
  for (std::size_t k = 0; k < settings.models.size(); ++k)
    models.push_back(modelOf(settings.models[k], section.part("models", k)));
  for (std::size_t k = 0; k < settings.solids.size(); ++k)
    solids.push_back(solidOf(settings.solids[k], section.part("solids", k)));
  requireDistinct(models, "models", section);
  requireDistinct(lighting.lights, "lights", lights);
  requireDistinct(solids, "solids", section);
  for (const SolidEntry& solid : solids) {
    const auto same = [&](const ModelEntry& model) { return model.name == solid.name; };
    if (std::any_of(models.begin(), models.end(), same)) {
      section.fault("solids", "a solid and a model named '" + solid.name + "'", "distinct names");
    }
  }
}

SceneConfig SceneConfig::fromYaml(const YAML::Node& node) {
  std::optional<SceneConfig> scene;
  readSection<SceneKeys>(node, "scene", [&scene](const SceneKeys& settings, const SectionCheck& section) {
    scene.emplace(settings, section);
  });
  return *scene;
}

// What a Gazebo world with its model "sun" is lit by.
void SceneConfig::lightAsGazebo() {
  constexpr double kAmbient = 0.4, kBackground = 0.7, kDiffuse = 0.8, kSpecular = 0.1;
  if (!has_background) {
    const auto grey = static_cast<std::uint8_t>(std::lround(255.0 * kBackground));
    background = {grey, grey, grey};
  }
  lighting.as_coverage = false;
  if (has_lights) return;
  Light sun;
  sun.name = "sun";
  sun.direction_W = {-0.5, 0.5, -1.0};
  sun.diffuse.setConstant(kDiffuse);
  sun.specular.setConstant(kSpecular);
  lighting.ambient.setConstant(kAmbient);
  lighting.lights = {sun};
}

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
