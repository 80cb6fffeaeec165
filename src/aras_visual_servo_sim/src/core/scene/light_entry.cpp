#include "aras_visual_servo_sim/scene/light_entry.hpp"

#include <algorithm>
#include <aras_visual_servo_common/files.hpp>
#include <cmath>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "aras_visual_servo_sim/robot/sdf_light.hpp"
#include "scene_settings.hpp"

namespace aras_visual_servo_sim {
namespace {

constexpr double kGreyLevels = 255.0;

YAML::Node numbers(const Eigen::Vector3d& values) {
  YAML::Node node;
  for (const double value : values) node.push_back(value);
  return node;
}

const char* nameOf(Light::Type type) {
  return type == Light::Type::kDirectional ? "directional" : type == Light::Type::kPoint ? "point" : "spot";
}

}  // namespace

Light lightFromYaml(const YAML::Node& node) { return lightOf(readSection<LightConfig>(node, "light", checkLight)); }

YAML::Node lightYaml(const Light& light) {
  const bool attached = !light.attached_to.empty();
  const double intensity = std::max({1.0, light.diffuse.maxCoeff(), light.specular.maxCoeff()});
  YAML::Node node;
  node["name"] = light.name;
  node["type"] = nameOf(light.type);
  if (attached) node["attached_to"] = light.attached_to;
  if (light.type != Light::Type::kDirectional) {
    node["position_m"] = numbers(attached ? light.position_A : light.position_W);
  }
  if (light.type != Light::Type::kPoint) {
    node["direction"] = numbers(attached ? light.direction_A : light.direction_W);
  }
  node["color_rgb"] = numbers(kGreyLevels / intensity * light.diffuse);
  node["specular_rgb"] = numbers(kGreyLevels / intensity * light.specular);
  node["intensity"] = intensity;
  node["casts_shadows"] = light.casts_shadows;
  if (light.type == Light::Type::kDirectional) return node;
  node["range_m"] = light.range_m;
  node["attenuation_constant"] = light.constant;
  node["attenuation_linear"] = light.linear_per_m;
  node["attenuation_quadratic"] = light.quadratic_per_m2;
  if (light.type == Light::Type::kPoint) return node;
  node["inner_angle_rad"] = light.inner_angle_rad;
  node["outer_angle_rad"] = light.outer_angle_rad;
  node["falloff"] = light.falloff;
  return node;
}

Light lightFromSdf(const std::string& xml, const std::string& source, std::vector<std::string>* warnings) {
  const SdfLight read = readSdfLight(xml, source, warnings);
  Light light;
  light.name = read.name;
  light.type = read.type == SdfLight::Type::kDirectional ? Light::Type::kDirectional
               : read.type == SdfLight::Type::kPoint     ? Light::Type::kPoint
                                                         : Light::Type::kSpot;
  light.position_W = light.position_A = read.X_AL.p;
  light.direction_W = light.direction_A = read.direction_A;
  light.diffuse = read.diffuse;
  light.specular = read.specular;
  light.range_m = read.range_m;
  light.constant = read.constant;
  light.linear_per_m = read.linear_per_m;
  light.quadratic_per_m2 = read.quadratic_per_m2;
  light.inner_angle_rad = read.inner_angle_rad;
  light.outer_angle_rad = read.outer_angle_rad;
  light.falloff = read.falloff;
  light.casts_shadows = read.casts_shadows;
  return light;
}

Light lightFromText(const std::string& text) {
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  if (first == std::string::npos) throw ParameterError("light: found an empty text, allowed SDF or YAML");
  if (text[first] == '<') return lightFromSdf(text, "light");
  try {
    return lightFromYaml(aras_visual_servo_common::parseYaml(text, aras_visual_servo_common::kMostSentYaml));
  } catch (const ParameterError&) {
    throw;
  } catch (const ArasError& error) {
    throw ParameterError(std::string("light: ") + error.what());
  }
}

Rgb colorOf(const Eigen::Vector3d& rgb) {
  const auto byte = [](double value) { return static_cast<std::uint8_t>(std::lround(value)); };
  return {byte(rgb[0]), byte(rgb[1]), byte(rgb[2])};
}

Light lightOf(const LightConfig& settings) {
  Light light;
  light.name = settings.name;
  light.type = settings.type;
  light.position_W = light.position_A = settings.position_m;
  if (light.type != Light::Type::kPoint) light.direction_W = settings.direction.value_or(light.direction_W);
  light.direction_A = light.direction_W;
  light.attached_to = settings.attached_to.value_or("");
  light.diffuse = settings.intensity * (settings.color_rgb / kGreyLevels);
  light.specular = settings.intensity * (settings.specular_rgb / kGreyLevels);
  light.range_m = settings.range_m;
  light.constant = settings.attenuation_constant;
  light.linear_per_m = settings.attenuation_linear;
  light.quadratic_per_m2 = settings.attenuation_quadratic;
  light.inner_angle_rad = settings.inner_angle_rad;
  light.outer_angle_rad = settings.outer_angle_rad;
  light.falloff = settings.falloff;
  light.casts_shadows = settings.casts_shadows;
  return light;
}

void checkLight(const LightConfig& light, const SectionCheck& section) {
  const std::string whose = " of light '" + light.name + "'";
  if (light.type != Light::Type::kPoint && section.has("type")) {
    if (!light.direction) {
      section.fault("direction", "none" + whose, "where a directional or spot light travels");
    } else if (light.direction->norm() == 0.0) {
      section.fault("direction", "zero" + whose, "any other direction");
    }
  }
  if (light.type == Light::Type::kSpot && !(light.outer_angle_rad > light.inner_angle_rad)) {
    section.fault("outer_angle_rad", numberText(light.outer_angle_rad) + whose,
                  "more than inner_angle_rad, " + numberText(light.inner_angle_rad));
  }
}

Lighting lightingOf(const LightingConfig& settings) {
  Lighting lighting;
  lighting.ambient = settings.ambient_rgb / kGreyLevels;
  for (const LightConfig& light : settings.lights) lighting.lights.push_back(lightOf(light));
  lighting.as_coverage = lighting.lights.empty();
  lighting.shadows = settings.shadows;
  lighting.shadow_map_px = settings.shadow_map_px;
  if (settings.fog) lighting.fog = Fog{colorOf(settings.fog->color_rgb), settings.fog->density_per_m};
  if (settings.zenith_rgb) lighting.zenith = colorOf(*settings.zenith_rgb);
  return lighting;
}

Material materialOf(const MaterialConfig& settings) {
  Material material;
  material.ambient_share = settings.ambient_share;
  material.specular = settings.specular_rgb / kGreyLevels;
  material.shininess = settings.shininess;
  material.emissive = settings.emissive_rgb / kGreyLevels;
  material.opacity = settings.opacity;
  material.two_sided = settings.two_sided;
  return material;
}

}  // namespace aras_visual_servo_sim
