#include "aras_visual_servo_camera/vision_config.hpp"

#include <string>

#include "aras_visual_servo_camera/yaml_reader.hpp"

namespace aras_visual_servo_camera {
namespace {

constexpr double kMaxGrey = 255.0;
constexpr int kMaxPixels = 1 << 28;
constexpr int kMaxOrder = 8;
constexpr double kMaxRatio = 1e6;
constexpr int kMaxImages = 1 << 20;
constexpr double kMaxExponent = 8.0, kMinExponent = 0.01;
constexpr int kMinCorners = 3, kMaxPoints = 32;

std::optional<double> optionalGrey(YamlReader& reader, const std::string& key) {
  if (!reader.has(key)) {
    reader.ignore(key);
    return std::nullopt;
  }
  return reader.requiredNumber(key, 0.0, kMaxGrey);
}

}  // namespace

VisionConfig readVisionConfig(const YAML::Node& node) {
  YamlReader reader(node, "vision");
  VisionConfig c;
  c.object = static_cast<ObjectShade>(reader.requiredChoice("object", {"dark", "bright"}));
  c.segmentation =
      static_cast<SegmentationMethod>(reader.requiredChoice("segmentation", {"fixed", "otsu", "adaptive", "coverage"}));
  c.threshold = c.segmentation == SegmentationMethod::kFixed
                    ? reader.requiredNumber("threshold", 0.0, kMaxGrey)
                    : reader.optionalNumber("threshold", 0.0, kMaxGrey, c.threshold);
  c.object_grey = optionalGrey(reader, "object_grey");
  c.background_grey = optionalGrey(reader, "background_grey");
  c.min_contrast = reader.optionalNumber("min_contrast", 1.0, kMaxGrey, c.min_contrast);
  c.adaptive_block_px = reader.optionalInteger("adaptive_block_px", 3, kMaxPixels - 1, c.adaptive_block_px);
  c.adaptive_offset = reader.optionalNumber("adaptive_offset", 0.0, kMaxGrey, c.adaptive_offset);
  c.component = static_cast<ComponentChoice>(reader.optionalChoice(
      "component", {"largest", "nearest_to_previous", "most_similar"}, static_cast<int>(c.component)));
  c.min_area_px = reader.optionalInteger("min_area_px", 1, kMaxPixels, c.min_area_px);
  if (reader.has("lost_area_px")) {
    c.lost_area_px = reader.requiredInteger("lost_area_px", 1, kMaxPixels);
    if (*c.lost_area_px > c.min_area_px)
      reader.fault("lost_area_px", std::to_string(*c.lost_area_px),
                   "at most min_area_px, " + std::to_string(c.min_area_px));
  } else {
    reader.ignore("lost_area_px");
  }
  c.border_margin_px = reader.optionalInteger("border_margin_px", 0, kMaxPixels, c.border_margin_px);
  c.switch_ratio = reader.optionalNumber("switch_ratio", 1.0, kMaxRatio, c.switch_ratio);
  c.switch_images = reader.optionalInteger("switch_images", 1, kMaxImages, c.switch_images);
  c.order = reader.optionalInteger("order", 3, kMaxOrder, c.order);
  c.asymmetry_threshold = reader.optionalNumber("asymmetry_threshold", 0.0, 1.0, c.asymmetry_threshold);
  c.orientation_threshold = reader.optionalNumber("orientation_threshold", 0.0, 1.0, c.orientation_threshold);
  c.points = static_cast<PointSource>(
      reader.optionalChoice("points", {"none", "corners", "blobs"}, static_cast<int>(c.points)));
  const int fewest = c.points == PointSource::kCorners ? kMinCorners : 1;
  c.point_count = c.points == PointSource::kNone ? reader.optionalInteger("point_count", 1, kMaxPoints, c.point_count)
                                                 : reader.requiredInteger("point_count", fewest, kMaxPoints);

  if (c.adaptive_block_px % 2 == 0)
    reader.fault("adaptive_block_px", std::to_string(c.adaptive_block_px), "an odd number");
  if (c.object_grey && c.background_grey) {
    const double contrast = *c.background_grey - *c.object_grey;
    const bool dark = c.object == ObjectShade::kDark;
    if ((dark ? contrast : -contrast) < 1.0)
      reader.fault("object_grey", std::to_string(*c.object_grey),
                   std::string(dark ? "at least 1 below" : "at least 1 above") + " background_grey, " +
                       std::to_string(*c.background_grey));
  }
  reader.ignore("kernel");
  if (reader.has("kernel")) {
    YamlReader section(node["kernel"], "vision/kernel");
    c.kernel.emplace();
    c.kernel->p = section.optionalNumber("p", kMinExponent, kMaxExponent, c.kernel->p);
    c.kernel->q = section.optionalNumber("q", kMinExponent, kMaxExponent, c.kernel->q);
    try {
      section.finish();
    } catch (const ParameterError& faults) {
      reader.adopt(faults);
    }
  }
  reader.ignore("photometric");
  if (reader.has("photometric")) {
    try {
      c.photometric = readPhotometricConfig(node["photometric"]);
    } catch (const ParameterError& faults) {
      reader.adopt(faults);
    }
  }
  reader.finish();
  return c;
}

}  // namespace aras_visual_servo_camera
