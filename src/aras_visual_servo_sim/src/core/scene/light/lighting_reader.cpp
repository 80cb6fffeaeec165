#include "lighting_reader.hpp"

#include "scene/light/color_reader.hpp"

namespace aras_visual_servo_sim {
namespace {

constexpr double kGreyLevels = 255.0;

/** 0 .. 1. */
Eigen::Vector3d readIntensity(YamlReader& reader, const char* key) {
  return reader.get<Eigen::Vector3d>(key) / kGreyLevels;
}

}  // namespace

Light readLight(YamlReader& reader) {
  Light light;
  light.name = reader.get<std::string>("name");
  light.type = reader.choice<Light::Type>(
      "type",
      {{"directional", Light::Type::kDirectional}, {"point", Light::Type::kPoint}, {"spot", Light::Type::kSpot}});
  light.position_W = reader.get<Eigen::Vector3d>("position_m");
  const auto direction = reader.find<Eigen::Vector3d>("direction");
  if (light.type != Light::Type::kPoint) {
    if (!direction) {
      reader.fault("direction", "none of light '" + light.name + "'", "where a directional or spot light travels");
    } else if (direction->norm() == 0.0) {
      reader.fault("direction", "zero of light '" + light.name + "'", "any other direction");
    } else {
      light.direction_W = *direction;
    }
  }
  light.attached_to = reader.find<std::string>("attached_to").value_or("");
  light.position_A = light.position_W;
  light.direction_A = light.direction_W;
  const auto intensity = reader.get<double>("intensity");
  light.diffuse = intensity * readIntensity(reader, "color_rgb");
  light.specular = intensity * readIntensity(reader, "specular_rgb");
  light.range_m = reader.get<double>("range_m");
  light.constant = reader.get<double>("attenuation_constant");
  light.linear_per_m = reader.get<double>("attenuation_linear");
  light.quadratic_per_m2 = reader.get<double>("attenuation_quadratic");
  light.inner_angle_rad = reader.get<double>("inner_angle_rad");
  light.outer_angle_rad = reader.get<double>("outer_angle_rad");
  if (light.type == Light::Type::kSpot && !(light.outer_angle_rad > light.inner_angle_rad)) {
    reader.fault("outer_angle_rad", std::to_string(light.outer_angle_rad) + " of light '" + light.name + "'",
                 "more than inner_angle_rad, " + std::to_string(light.inner_angle_rad));
  }
  light.falloff = reader.get<double>("falloff");
  light.casts_shadows = reader.get<bool>("casts_shadows");
  return light;
}

Lighting readLighting(YamlReader& reader) {
  Lighting lighting;
  lighting.ambient = readIntensity(reader, "ambient_rgb");
  for (YamlReader& light : reader.list("lights")) lighting.lights.push_back(readLight(light));
  lighting.as_coverage = lighting.lights.empty();
  lighting.shadows = reader.get<bool>("shadows");
  lighting.shadow_map_px = static_cast<int>(reader.get<std::int64_t>("shadow_map_px"));
  if (reader.has("fog")) {
    YamlReader fog = reader.section("fog");
    lighting.fog = Fog{readColor(fog, "color_rgb"), fog.get<double>("density_per_m")};
  }
  if (reader.has("zenith_rgb")) lighting.zenith = readColor(reader, "zenith_rgb");
  return lighting;
}

Material readMaterial(YamlReader& reader) {
  Material material;
  material.ambient_share = reader.get<double>("ambient_share");
  material.specular = readIntensity(reader, "specular_rgb");
  material.shininess = reader.get<double>("shininess");
  material.emissive = readIntensity(reader, "emissive_rgb");
  material.opacity = reader.get<double>("opacity");
  material.two_sided = reader.get<bool>("two_sided");
  return material;
}

}  // namespace aras_visual_servo_sim
