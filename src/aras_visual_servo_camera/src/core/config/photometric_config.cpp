#include "aras_visual_servo_camera/config/photometric_config.hpp"

#include <aras_visual_servo_common/text.hpp>

#include "config/read_photometric.hpp"
#include "schema_sections.hpp"

namespace aras_visual_servo_camera {

using aras_visual_servo_common::YamlReader;

PhotometricConfig readPhotometric(YamlReader reader) {
  PhotometricConfig c{};
  c.interaction = reader.choice<GradientOf>(
      "interaction",
      {{"desired", GradientOf::kDesired}, {"current", GradientOf::kCurrent}, {"mean", GradientOf::kMean}});
  c.illumination = reader.choice<Illumination>("illumination", {{"constant", Illumination::kConstant},
                                                                {"offset", Illumination::kOffset},
                                                                {"gain_and_offset", Illumination::kGainAndOffset}});
  c.levels = reader.get<int>("levels");
  c.switch_px = reader.get<double>("switch_px");
  c.smoothing_px = reader.get<double>("smoothing_px");
  c.border_px = reader.get<int>("border_px");
  c.min_contrast = reader.get<double>("min_contrast");
  c.target_normal_C = reader.get<std::array<double, 3>>("target_normal_C");
  if (!(c.target_normal_C[2] > 0.0))
    reader.fault("target_normal_C", aras_visual_servo_common::numberText(c.target_normal_C[2]) + " as the last",
                 "> 0 there, away from the camera");
  return c;
}

PhotometricConfig readPhotometricConfig(const YAML::Node& node) {
  YamlReader reader(node, schemaSections().section("photometric"), "vision/photometric");
  const PhotometricConfig config = readPhotometric(reader);
  reader.finish();
  return config;
}

}  // namespace aras_visual_servo_camera
