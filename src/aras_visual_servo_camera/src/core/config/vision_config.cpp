// Checks that the schema cannot express.
#include "aras_visual_servo_camera/config/vision_config.hpp"

#include <aras_visual_servo_common/text.hpp>

namespace aras_visual_servo_camera {
namespace {

using aras_visual_servo_common::numberOf;
using aras_visual_servo_common::numberText;
using aras_visual_servo_common::readSection;
using aras_visual_servo_common::SectionCheck;
using aras_visual_servo_common::shown;

void checkOdd(const SectionCheck& section, const char* key, int value) {
  if (value % 2 == 0) section.fault(key, value, "an odd number");
}

void checkDepth(const std::optional<DepthConfig>& depth, const SectionCheck& section) {
  if (depth) checkOdd(section.part("depth"), "window_px", depth->window_px);
}

void checkMatching(const MatchingConfig& c, const SectionCheck& section) {
  checkDepth(c.depth, section);
  if (c.keypoints < c.min_matches)
    section.fault("keypoints", c.keypoints, ">= min_matches, " + numberText(c.min_matches));
}

void checkMappings(const PhotometricConfig& c, const SectionCheck& section) {
  if (c.pca.components > c.pca.views)
    section.part("pca").fault("components", c.pca.components, "<= views, " + numberText(c.pca.views));
  if (c.mixture.final_extension_px > c.mixture.extension_px)
    section.part("mixture").fault("final_extension_px", c.mixture.final_extension_px,
                                  "<= extension_px, " + numberText(c.mixture.extension_px));
  if (c.mapping == Mapping::kMixture && c.levels > 1)
    section.fault("levels", c.levels, "1 with mapping mixture, whose extension takes their place");
  if (c.mapping != Mapping::kMutualInformation) return;
  // The gradient of the information is that of the current image, and light needs no columns of its own.
  if (section.has("interaction") && c.interaction != GradientOf::kCurrent)
    section.fault("interaction", shown(section.node("interaction")), "current with mapping mutual_information");
  if (c.illumination != Illumination::kConstant)
    section.fault("illumination", shown(section.node("illumination")), "constant with mapping mutual_information");
}

void checkPhotometric(PhotometricConfig& c, const SectionCheck& section) {
  checkMappings(c, section);
  if (c.mapping == Mapping::kMutualInformation) c.interaction = GradientOf::kCurrent;
  if (!(c.target_normal_C[2] > 0.0))
    section.fault("target_normal_C", numberText(c.target_normal_C[2]) + " as the last",
                  "> 0 there, away from the camera");
}

void checkColour(const ObjectColour& colour, const SectionCheck& section) {
  const SectionCheck part = section.part("object");
  const YAML::Node hue = part.node("hue_deg");
  if (hue && hue.IsSequence() && hue.size() == 2 && numberOf(hue[0]) && numberOf(hue[0]) == numberOf(hue[1]))
    part.fault("hue_deg", shown(hue), "two angles that differ");
  if (!(colour.saturation[0] < colour.saturation[1]))
    part.fault("saturation", shown(part.node("saturation")), "the least, and then a greater one");
  for (const char* key : {"threshold", "object_grey", "background_grey"})
    if (section.has(key)) section.fault(key, shown(section.node(key)), "nothing, because the object is a colour");
}

void checkSegmentation(const VisionConfig& c, const SectionCheck& section) {
  const ObjectColour* colour = std::get_if<ObjectColour>(&c.object);
  if (colour) checkColour(*colour, section);
  if (c.segmentation == SegmentationMethod::kFixed && section.has("segmentation") && !colour &&
      !section.has("threshold"))
    section.missing("threshold", "a number with segmentation fixed");
  checkOdd(section, "adaptive_block_px", c.adaptive_block_px);
  if (!colour && c.object_grey && c.background_grey) {
    const double contrast = *c.background_grey - *c.object_grey;
    const bool dark = isDark(c);
    if ((dark ? contrast : -contrast) < 1.0)
      section.fault("object_grey", *c.object_grey,
                    std::string(dark ? "at least 1 below" : "at least 1 above") + " background_grey, " +
                        numberText(*c.background_grey));
  }
  if (c.lost_area_px && *c.lost_area_px > c.min_area_px)
    section.fault("lost_area_px", *c.lost_area_px, "at most min_area_px, " + numberText(c.min_area_px));
}

void checkPoints(const VisionConfig& c, const SectionCheck& section) {
  if (c.points != PointSource::kNone && !section.has("point_count"))
    section.missing("point_count", "an integer with points corners or blobs");
  if (c.points == PointSource::kCorners && c.point_count && *c.point_count < 3)
    section.fault("point_count", *c.point_count, ">= 3 corners");
  if (c.rays && c.points != PointSource::kBlobs) section.fault("rays", "true", "false, or true with points blobs");
  if (c.depth && c.points == PointSource::kNone)
    section.fault("depth", "a section with points none", "with points corners or blobs");
}

void checkVision(VisionConfig& c, const SectionCheck& section) {
  checkSegmentation(c, section);
  checkPoints(c, section);
  checkDepth(c.depth, section);
  if (c.photometric) checkPhotometric(*c.photometric, section.part("photometric"));
  if (c.matches) checkMatching(*c.matches, section.part("matches"));
}

}  // namespace

VisionConfig readVisionConfig(const YAML::Node& node) { return readSection<VisionConfig>(node, "vision", checkVision); }

PhotometricConfig readPhotometricConfig(const YAML::Node& node) {
  return readSection<PhotometricConfig>(node, "vision.photometric", checkPhotometric);
}

MatchingConfig readMatchingConfig(const YAML::Node& node) {
  return readSection<MatchingConfig>(node, "vision.matches", checkMatching);
}

TagConfig readTagConfig(const YAML::Node& node) {
  return readSection<TagConfig>(node, "vision.tag", [](auto&&...) {});
}

}  // namespace aras_visual_servo_camera
