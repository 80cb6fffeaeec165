#include "aras_visual_servo_camera/config/vision_config.hpp"

#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include "text_of.hpp"

namespace aras_visual_servo_camera::vision_config_test {
namespace {

std::string faultsOf(const std::string& yaml) {
  return testing::textOf<ParameterError>([&] { readVisionConfig(YAML::Load(yaml)); });
}

/** A document with every key of the section, none as its default. */
const char kEveryKey[] =
    "{object: bright, segmentation: fixed, threshold: 100, object_grey: 200, background_grey: 30, min_contrast: 12, "
    "adaptive_block_px: 51, adaptive_offset: 7, component: nearest_to_previous, min_area_px: 9, order: 5, "
    "asymmetry_threshold: 0.1, orientation_threshold: 0.2, points: blobs, point_count: 5, "
    "kernel: {p: 2, q: 3}, lost_area_px: 4, border_margin_px: 3, switch_ratio: 1.5, switch_images: 7, "
    "photometric: {interaction: current, illumination: offset, levels: 2, switch_px: 0.6, smoothing_px: 1.5, "
    "border_px: 11, min_contrast: 4, target_normal_C: [0.1, 0.2, 0.9], mapping: dct, "
    "pca: {components: 12, views: 50, spread: 0.2, seed: 5}, dct: {coefficients: 20}, "
    "mixture: {extension_px: 30, final_extension_px: 3}, mutual_information: {bins: 10}}, "
    "matches: {detector: akaze, keypoints: 500, ratio: 0.7, inlier_px: 2, min_matches: 9, iterations: 300, seed: 7, "
    "depth: {window_px: 5}}, rays: true, depth: {window_px: 11, max_step: 0.1}, "
    "tag: {family: 25h9, id: 3, size_m: 0.12, min_side_px: 24}}";

TEST(VisionConfig, ReadsKeysOfEachKindAtEachDepth) {
  const VisionConfig c = readVisionConfig(YAML::Load(kEveryKey));
  EXPECT_EQ(std::get<ObjectShade>(c.object), ObjectShade::kBright);
  EXPECT_EQ(c.segmentation, SegmentationMethod::kFixed);
  EXPECT_EQ(c.component, ComponentChoice::kNearestToPrevious);
  EXPECT_EQ(c.points, PointSource::kBlobs);
  EXPECT_EQ(c.object_grey.value(), 200.0);
  EXPECT_EQ(c.order, 5);
  EXPECT_TRUE(c.rays);
  EXPECT_EQ(c.kernel.value().q, 3.0);
  EXPECT_EQ(c.matches.value().detector, KeypointDetector::kAkaze);
  EXPECT_EQ(c.matches.value().depth.value().window_px, 5);
  EXPECT_EQ(c.tag.value().family, "25h9");
  const PhotometricConfig& p = c.photometric.value();
  EXPECT_EQ(p.interaction, GradientOf::kCurrent);
  EXPECT_EQ(p.illumination, Illumination::kOffset);
  EXPECT_EQ(p.mapping, Mapping::kDct);
  EXPECT_EQ(p.target_normal_C, Eigen::Vector3d(0.1, 0.2, 0.9));
  EXPECT_EQ(p.mixture.final_extension_px, 3.0);
}

TEST(VisionConfig, WhatIsLeftOutIsNotMadeUp) {
  const VisionConfig c = readVisionConfig(YAML::Load("{object: dark, segmentation: coverage}"));
  EXPECT_EQ(c.points, PointSource::kNone);
  EXPECT_FALSE(c.kernel || c.object_grey || c.background_grey || c.photometric || c.matches || c.tag || c.depth);
}

TEST(VisionConfig, AnObjectMayBeAColour) {
  const VisionConfig c =
      readVisionConfig(YAML::Load("{object: {hue_deg: [340, 20], saturation: [0.5, 0.9]}, segmentation: fixed}"));
  const auto& colour = std::get<ObjectColour>(c.object);
  EXPECT_EQ(colour.hue_deg, Eigen::Vector2d(340.0, 20.0));
  EXPECT_EQ(colour.saturation, Eigen::Vector2d(0.5, 0.9));
  EXPECT_FALSE(isDark(c));
  EXPECT_TRUE(isDark(readVisionConfig(YAML::Load("{object: dark, segmentation: coverage}"))));
}

TEST(VisionConfig, FaultsOfAColourAreListedAtOnce) {
  for (const auto& [object, parts] : std::vector<std::pair<std::string, std::vector<std::string>>>{
           {"{hue_deg: [20, 20]}", {"vision.object.hue_deg: found [20, 20]"}},
           {"{hue_deg: [0, 20], saturation: [0.9, 0.5]}", {"vision.object.saturation: found [0.9, 0.5]"}},
           {"{hue_deg: [-20, 20], saturation: [0.1, 2]}",
            {"vision.object.hue_deg: found", "vision.object.saturation: found"}},
           {"{hue_deg: [20], hues: 3}",
            {"vision.object.hue_deg: found [20]", "vision.object.hues: found an unknown key"}},
           {"{saturation: [0.1, 1]}", {"vision.object.hue_deg: found nothing"}},
           {"{}", {"vision.object.hue_deg: found nothing"}}}) {
    const std::string faults = faultsOf("{segmentation: coverage, order: 2, object: " + object + "}");
    EXPECT_NE(faults.find("vision.order: found 2"), std::string::npos) << faults;
    for (const std::string& part : parts) EXPECT_NE(faults.find(part), std::string::npos) << object << ": " << faults;
  }
  const std::string faults =
      faultsOf("{segmentation: fixed, object: {hue_deg: [0, 9]}, threshold: 3, object_grey: 4, background_grey: 90}");
  for (const char* key : {"threshold: found 3", "object_grey: found 4", "background_grey: found 90"})
    EXPECT_NE(faults.find(std::string("vision.") + key), std::string::npos) << faults;
}

TEST(VisionConfig, FaultsOfSeveralKeysAreListedAtOnce) {
  const std::string usual = "{object: dark, segmentation: coverage, ";
  const std::pair<std::string, std::vector<std::string>> kCases[] = {
      {usual + "order: 2, kernel: {p: 0, r: 1}}",
       {"vision.order", "vision.kernel.p: found 0, allowed >= 0.01 and <= 8", "vision.kernel.r: found an unknown key"}},
      {usual + "points: corners}", {"vision.point_count"}},
      {usual + "points: corners, point_count: 2}", {"found 2, allowed >= 3"}},
      {usual + "depth: {}}", {"vision.depth: found a section with points none, allowed with points corners or blobs"}},
      {usual + "points: none, point_count: 4, rays: true}",
       {"vision.rays: found true, allowed false, or true with points blobs"}},
      {usual + "points: corners, point_count: 4, rays: true}",
       {"vision.rays: found true, allowed false, or true with points blobs"}},
      {usual + "points: blobs, point_count: 1, depth: {window_px: 4}}",
       {"vision.depth.window_px: found 4, allowed an odd number"}},
      {usual + "object_grey: 200, background_grey: 20}", {"object_grey"}},
      {"{object: bright, segmentation: coverage, object_grey: 20, background_grey: 200}", {"object_grey"}},
      {"{object: dark, segmentation: fixed}", {"vision.threshold"}},
      {"{order: 3}", {"vision.object: found nothing", "vision.segmentation: found nothing"}},
      {"", {"vision.object: found nothing"}},
      {"[1, 2]", {"vision: found [1, 2], allowed a map"}},
      {"{object: green, segmentation: coverage, order: 2, min_area: 3}",
       {"vision.object: found green, allowed one of dark, bright", "vision.order: found 2",
        "vision.min_area: found an unknown key"}}};
  for (const auto& [document, parts] : kCases) {
    const std::string faults = faultsOf(document);
    for (const std::string& part : parts) EXPECT_NE(faults.find(part), std::string::npos) << document << faults;
  }
  EXPECT_EQ(faultsOf("{order: 3}").find("threshold"), std::string::npos) << "only `fixed` asks for one";
  EXPECT_EQ(faultsOf(usual + "points: corners, point_count: 3, depth: {}}"), "");
  EXPECT_EQ(faultsOf(usual + "points: blobs, point_count: 1, rays: true}"), "");
}

class BadValue : public ::testing::TestWithParam<std::pair<const char*, const char*>> {};

TEST_P(BadValue, IsRefusedByName) {
  const auto [key, value] = GetParam();
  const std::string object = std::string(key) == "object" ? "" : "object: dark, ";
  const std::string method = std::string(key) == "segmentation" ? "" : "segmentation: coverage, ";
  const std::string faults = faultsOf("{" + object + method + key + ": " + value + "}");
  EXPECT_NE(faults.find(std::string("vision.") + key + ": found"), std::string::npos) << faults;
}

INSTANTIATE_TEST_SUITE_P(EachKey, BadValue,
                         ::testing::Values(std::pair("object", "grey"), std::pair("object", "[dark]"),
                                           std::pair("segmentation", "soft"), std::pair("threshold", "-1"),
                                           std::pair("threshold", "256"), std::pair("threshold", "'128'"),
                                           std::pair("object_grey", ".nan"), std::pair("object_grey", "300"),
                                           std::pair("background_grey", "dark"), std::pair("min_contrast", "0"),
                                           std::pair("adaptive_block_px", "50"), std::pair("adaptive_block_px", "1"),
                                           std::pair("adaptive_offset", "-3"), std::pair("component", "biggest"),
                                           std::pair("min_area_px", "0"), std::pair("min_area_px", "2.5"),
                                           std::pair("lost_area_px", "51"), std::pair("border_margin_px", "-1"),
                                           std::pair("switch_ratio", "0.9"), std::pair("switch_images", "0"),
                                           std::pair("order", "2"), std::pair("order", "9"), std::pair("order", "null"),
                                           std::pair("asymmetry_threshold", "-0.1"),
                                           std::pair("orientation_threshold", "1.5")));

}  // namespace
}  // namespace aras_visual_servo_camera::vision_config_test
