// Defocus by depth, against the geometry of a thin lens.
#include "aras_visual_servo_sim/image/sensor/depth_blur.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "tools/messages.hpp"
#include "tools/pan_lift.hpp"

namespace aras_visual_servo_sim::depth_blur_test {
namespace {

constexpr double kFocal_m = 0.008, kFNumber = 1.4, kFocus_m = 0.6, kFocal_px = 2000.0;
constexpr float kNothing = std::numeric_limits<float>::quiet_NaN();

ThinLens lens() { return {kFocus_m, kFocal_m, kFNumber, kFocal_px}; }

/** Where light of a point at this depth meets behind the lens [m]. */
double imageDistance(double depth_m) { return 1.0 / (1.0 / kFocal_m - 1.0 / depth_m); }

TEST(ThinLens, DiameterIsThatOfTheConeOfLightAtTheSensor) {
  const double sensor_m = imageDistance(kFocus_m), pixel_m = sensor_m / kFocal_px;
  for (const double depth_m : {0.1, 0.3, 0.59, 0.6, 0.7, 2.0, 50.0}) {
    // The cone is as wide as the aperture at the lens, and nothing where the light meets.
    const double meets_m = imageDistance(depth_m);
    const double cone_m = kFocal_m / kFNumber * std::abs(sensor_m - meets_m) / meets_m;
    EXPECT_NEAR(lens().diameterPx(depth_m), std::min(64.0, cone_m / pixel_m), 1e-9) << depth_m;
  }
  EXPECT_NEAR(lens().diameterPx(std::nan("")), kFocal_px * kFocal_m / kFNumber / kFocus_m, 1e-9);
  EXPECT_EQ(lens().diameterPx(kFocus_m), 0.0);
}

constexpr int kWidth = 80, kHeight = 48, kEdge = 40;

/** Dark left of the edge, bright right of it, each at its depth, after the lens. */
FineImage edgeThrough(float left_m, float right_m) {
  FineImage image;
  image.resize(kWidth, kHeight, Encoding::kMono8);
  std::vector<float> depth(std::size_t(kWidth) * kHeight);
  for (int v = 0; v < kHeight; ++v) {
    for (int u = 0; u < kWidth; ++u) {
      *image.pixel(u, v) = u < kEdge ? 10000 : 60000;
      depth[std::size_t(v) * kWidth + u] = u < kEdge ? left_m : right_m;
    }
  }
  DepthBlur(lens()).apply(depth, image);
  return image;
}

/** The part of a disc about the middle of column u that lies beyond the edge. */
double beyondEdge(int u, double diameter_px) {
  const double x = std::clamp((u - (kEdge - 0.5)) / (0.5 * diameter_px), -1.0, 1.0);
  return 0.5 + (std::asin(x) + x * std::sqrt(1.0 - x * x)) / M_PI;
}

// Diameters are multiples of 1/8 px, and shares are counted on a grid of 1/32 px.
constexpr double kTolerance = 5e-3 * 50000;

TEST(DepthBlur, EdgeInOnePlaneIsThatOfItsDisc) {
  for (const float depth_m : {0.4f, 0.45f, 0.6f, 0.8f, 3.0f, kNothing}) {
    const FineImage image = edgeThrough(depth_m, depth_m);
    const double diameter = lens().diameterPx(depth_m);
    for (int u = 0; u < kWidth; ++u) {
      const double expected = diameter < 1.0 ? (u < kEdge ? 0.0 : 1.0) : beyondEdge(u, diameter);
      EXPECT_NEAR(*image.pixel(u, 24), 10000 + 50000 * expected, kTolerance) << depth_m << ' ' << u;
    }
  }
}

TEST(DepthBlur, EachDepthIsAsBlurredAsThePlaneAloneWouldBe) {
  // Two planes of nearly one depth, each of its own: neither hides the other by more than its blur.
  const FineImage image = edgeThrough(0.400f, 0.401f);
  for (int u = 0; u < kWidth; ++u) {
    EXPECT_NEAR(*image.pixel(u, 24), 10000 + 50000 * beyondEdge(u, lens().diameterPx(0.4)), 4 * kTolerance) << u;
  }
}

TEST(DepthBlur, SharpThingsBeforeABlurredBackgroundStaySharp) {
  const FineImage image = edgeThrough(kFocus_m, kNothing);
  for (int u = 0; u < kWidth; ++u) EXPECT_EQ(*image.pixel(u, 24), u < kEdge ? 10000 : 60000) << u;
}

TEST(DepthBlur, BlurredThingsCoverTheSharpOnesBehindThem) {
  const FineImage image = edgeThrough(0.3f, kFocus_m);
  const int reach = static_cast<int>(0.5 * lens().diameterPx(0.3)) - 1;
  EXPECT_LT(*image.pixel(kEdge + 1, 24), 59000);  // the near, dark one reaches over the bright one
  EXPECT_LT(*image.pixel(kEdge + reach / 2, 24), 60000);
  EXPECT_EQ(*image.pixel(kEdge + reach + 3, 24), 60000);
}

TEST(DepthBlur, IsTheSameAtAllDepthsForAPlaneAslantOfLittleSlope) {
  FineImage image;
  image.resize(kWidth, kHeight, Encoding::kRgb8);
  std::fill(image.data.begin(), image.data.end(), 30000);
  std::vector<float> depth;
  for (int k = 0; k < kWidth * kHeight; ++k) depth.push_back(0.3f + 0.01f * static_cast<float>(k % kWidth));
  DepthBlur(lens()).apply(depth, image);
  for (const std::uint16_t value : image.data) ASSERT_NEAR(value, 30000, 1);  // what is even stays so
}

/** What a camera sees, half a metre away, of a board whose left half is dark. */
Image seenThrough(const std::string& renderer) {
  Simulation simulation = fixture::panLift(
      "{gravity_m_s2: [0, 0, 0], cameras: [{name: camera, frame: eye_optical_frame, width: 160, height: 40, "
      "fx_px: 200, fy_px: 200, encoding: mono8, renderer: " +
      renderer +
      ", sensor: {shot_noise: false, depth_of_field: {focus_distance_m: 0.25, focal_length_m: 0.025, f_number: "
      "1.0}}}], "
      "scene: {models: [{name: target, color_rgb: [0, 0, 0], board: {size_m: [4, 4], color_rgb: [240, 240, 240]}, "
      "outlines_m: [[[-2, -2], [0, -2], [0, 2], [-2, 2]]]}]}}");
  return simulation.render(0);
}

TEST(DepthBlur, CamerasOfBothRenderersBlurByTheDepthThatTheySee) {
  constexpr double kDiameter = 200 * 0.025 * (1 / 0.25 - 1 / 0.5), kMiddle = 79.5;
  for (const char* renderer : {"coverage", "opengl"}) {
    const Image image = seenThrough(renderer);
    for (int u = 60; u < 100; ++u) {
      const double x = std::clamp((u - kMiddle) / (0.5 * kDiameter), -1.0, 1.0);
      const double beyond = 0.5 + (std::asin(x) + x * std::sqrt(1.0 - x * x)) / M_PI;
      EXPECT_NEAR(*image.pixel(u, 20), 240.0 * beyond, 0.01 * 240.0) << renderer << ' ' << u;
    }
  }
}

TEST(DepthBlur, LensesThatCannotBeAreNamed) {
  for (const auto& [keys, named] :
       {std::pair<std::string, std::string>{"{focus_distance_m: 0.02, focal_length_m: 0.03, f_number: 2}",
                                            "focal_length_m"},
        {"{focus_distance_m: 1.0, focal_length_m: 0.03, f_number: 0}", "f_number"},
        {"{focus_distance_m: 1.0, focal_length_m: 0.03, f_number: 2}, defocus_px: 2", "defocus_px"},
        {"{focal_length_m: 0.03, f_number: 2}", "focus_distance_m"}}) {
    const std::string yaml =
        "{cameras: [{name: camera, frame: eye_optical_frame, width: 16, height: 8, fx_px: 20, fy_px: 20, "
        "sensor: {depth_of_field: " +
        keys + "}}]}";
    EXPECT_HAS(messageOf<ParameterError>([&] { fixture::panLift(yaml); }), named);
  }
}

}  // namespace
}  // namespace aras_visual_servo_sim::depth_blur_test
