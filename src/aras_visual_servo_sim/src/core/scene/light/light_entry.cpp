#include "aras_visual_servo_sim/scene/light_entry.hpp"

#include <algorithm>
#include <aras_visual_servo_common/files.hpp>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "aras_visual_servo_sim/robot/sdf_light.hpp"
#include "scene/light/lighting_reader.hpp"

namespace aras_visual_servo_sim {
namespace {

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
  node["color_rgb"] = numbers(255.0 / intensity * light.diffuse);
  node["specular_rgb"] = numbers(255.0 / intensity * light.specular);
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

}  // namespace aras_visual_servo_sim
