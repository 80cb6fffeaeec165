#include "aras_visual_servo_camera/config/vision_config.hpp"

#include <aras_visual_servo_common/yaml_reader.hpp>
#include <string>

#include "config/read_depth.hpp"
#include "config/read_matching.hpp"
#include "config/read_photometric.hpp"
#include "config/read_tag.hpp"
#include "schema_sections.hpp"

namespace aras_visual_servo_camera {
namespace {

using aras_visual_servo_common::YamlReader;

constexpr int kMinCorners = 3;

void readSegmentation(YamlReader& reader, VisionConfig& c) {
  c.object = reader.choice<ObjectShade>("object", {{"dark", ObjectShade::kDark}, {"bright", ObjectShade::kBright}});
  c.segmentation = reader.choice<SegmentationMethod>("segmentation", {{"coverage", SegmentationMethod::kCoverage},
                                                                      {"fixed", SegmentationMethod::kFixed},
                                                                      {"otsu", SegmentationMethod::kOtsu},
                                                                      {"adaptive", SegmentationMethod::kAdaptive}});
  c.threshold = c.segmentation == SegmentationMethod::kFixed ? reader.get<double>("threshold")
                                                             : reader.find<double>("threshold").value_or(0.0);
  c.object_grey = reader.find<double>("object_grey");
  c.background_grey = reader.find<double>("background_grey");
  c.min_contrast = reader.get<double>("min_contrast");
  c.adaptive_block_px = reader.get<int>("adaptive_block_px");
  c.adaptive_offset = reader.get<double>("adaptive_offset");
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
}

void readSelection(YamlReader& reader, VisionConfig& c) {
  c.component =
      reader.choice<ComponentChoice>("component", {{"largest", ComponentChoice::kLargest},
                                                   {"nearest_to_previous", ComponentChoice::kNearestToPrevious},
                                                   {"most_similar", ComponentChoice::kMostSimilar}});
  c.min_area_px = reader.get<int>("min_area_px");
  c.lost_area_px = reader.find<int>("lost_area_px");
  if (c.lost_area_px && *c.lost_area_px > c.min_area_px)
    reader.fault("lost_area_px", std::to_string(*c.lost_area_px),
                 "at most min_area_px, " + std::to_string(c.min_area_px));
  c.border_margin_px = reader.get<int>("border_margin_px");
  c.switch_ratio = reader.get<double>("switch_ratio");
  c.switch_images = reader.get<int>("switch_images");
}

void readFeatures(YamlReader& reader, VisionConfig& c) {
  c.order = reader.get<int>("order");
  c.asymmetry_threshold = reader.get<double>("asymmetry_threshold");
  c.orientation_threshold = reader.get<double>("orientation_threshold");
  c.points = reader.choice<PointSource>(
      "points", {{"none", PointSource::kNone}, {"corners", PointSource::kCorners}, {"blobs", PointSource::kBlobs}});
  c.point_count =
      c.points == PointSource::kNone ? reader.find<int>("point_count").value_or(0) : reader.get<int>("point_count");
  if (c.points == PointSource::kCorners && reader.has("point_count") && c.point_count < kMinCorners)
    reader.fault("point_count", std::to_string(c.point_count), ">= 3 corners");
  c.rays = reader.get<bool>("rays");
  if (c.rays && c.points != PointSource::kBlobs) reader.fault("rays", "true", "false, or true with points blobs");
  if (!reader.has("kernel")) return;
  YamlReader kernel = reader.section("kernel");
  c.kernel = VisionConfig::Kernel{kernel.get<double>("p"), kernel.get<double>("q")};
}

}  // namespace

VisionConfig readVisionConfig(const YAML::Node& node) {
  YamlReader reader(node, schemaSections().section("vision"), "vision");
  VisionConfig config{};
  readSegmentation(reader, config);
  readSelection(reader, config);
  readFeatures(reader, config);
  if (reader.has("depth")) {
    config.depth = readDepth(reader.section("depth"));
    if (config.points == PointSource::kNone)
      reader.fault("depth", "a section with points none", "with points corners or blobs");
  }
  if (reader.has("photometric")) config.photometric = readPhotometric(reader.section("photometric"));
  if (reader.has("matches")) config.matches = readMatching(reader.section("matches"));
  if (reader.has("tag")) config.tag = readTag(reader.section("tag"));
  reader.finish();
  return config;
}

}  // namespace aras_visual_servo_camera
