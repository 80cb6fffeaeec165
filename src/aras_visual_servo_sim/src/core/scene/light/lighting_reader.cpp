#include "lighting_reader.hpp"

#include <cmath>

namespace aras_visual_servo_sim {
namespace {

constexpr double kGreyLevels = 255.0;

}  // namespace

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
