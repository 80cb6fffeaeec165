#include "aras_visual_servo_camera/config/photometric_config.hpp"

#include <aras_visual_servo_common/text.hpp>
#include <string>

#include "config/read_photometric.hpp"
#include "schema_sections.hpp"

namespace aras_visual_servo_camera {

using aras_visual_servo_common::YamlReader;

namespace {

// The settings of every mapping, that of the others too, so that each key is checked.
void readMappings(YamlReader& reader, PhotometricConfig* c) {
  YamlReader pca = reader.section("pca"), dct = reader.section("dct"), mixture = reader.section("mixture");
  c->pca = {pca.get<int>("components"), pca.get<int>("views"), pca.get<double>("spread"), pca.get<int>("seed")};
  c->dct.coefficients = dct.get<int>("coefficients");
  c->mixture = {mixture.get<double>("extension_px"), mixture.get<double>("final_extension_px")};
  c->mutual_information.bins = reader.section("mutual_information").get<int>("bins");
  if (c->pca.components > c->pca.views)
    pca.fault("components", std::to_string(c->pca.components), "<= views, " + std::to_string(c->pca.views));
  if (c->mixture.final_extension_px > c->mixture.extension_px)
    mixture.fault("final_extension_px", aras_visual_servo_common::numberText(c->mixture.final_extension_px),
                  "<= extension_px, " + aras_visual_servo_common::numberText(c->mixture.extension_px));
}

// The gradient of the information is that of the current image, and light needs no columns of its own.
void readForMutualInformation(YamlReader& reader, PhotometricConfig* c) {
  if (reader.has("interaction") && c->interaction != GradientOf::kCurrent)
    reader.fault("interaction", reader.get<std::string>("interaction"), "current with mapping mutual_information");
  if (c->illumination != Illumination::kConstant)
    reader.fault("illumination", reader.get<std::string>("illumination"), "constant with mapping mutual_information");
  c->interaction = GradientOf::kCurrent;
}

}  // namespace

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
  c.mapping = reader.choice<Mapping>("mapping", {{"none", Mapping::kNone},
                                                 {"pca", Mapping::kPca},
                                                 {"dct", Mapping::kDct},
                                                 {"mixture", Mapping::kMixture},
                                                 {"mutual_information", Mapping::kMutualInformation}});
  readMappings(reader, &c);
  if (c.mapping == Mapping::kMixture && c.levels > 1)
    reader.fault("levels", std::to_string(c.levels), "1 with mapping mixture, whose extension takes their place");
  if (c.mapping == Mapping::kMutualInformation) readForMutualInformation(reader, &c);
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
