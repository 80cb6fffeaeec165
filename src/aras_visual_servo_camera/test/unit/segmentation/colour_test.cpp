// Objects that are told by their hue, with moments as good as those of black on white.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "aras_visual_servo_camera/extraction/moment_extractor.hpp"
#include "coverage_image.hpp"
#include "text_of.hpp"
#include "usual_vision.hpp"

namespace aras_visual_servo_camera::colour_test {
namespace {

using testing::GreyImage;
using testing::Polygon;

using Rgb = std::array<int, 3>;
constexpr Rgb kRed{200, 0, 0}, kGreen{0, 102, 0}, kWhite{255, 255, 255}, kBlack{0, 0, 0}, kBlue{30, 60, 220};
constexpr double kPi = 3.14159265358979323846;
constexpr double kFocal_px = 195.05;

// Of an object 66 px wide. The largest errors over the views below are 0.0004 px, 1.2e-5 and 0.0011 degrees with black
// on white, and 0.0006 px, 2.6e-5 and 0.0019 degrees with red on green, whose line is shorter and rounded twice.
constexpr double kCentroid_px = 0.001, kArea = 5e-5, kAlpha_deg = 0.003;

/** An image of two colours, from the coverage of the object's pixels. */
struct ColourImage {
  int width, height;
  std::vector<std::uint8_t> data;

  ColourImage(const Polygon& seen, const CameraIntrinsics& camera, const Rgb& object, const Rgb& background)
      : width(camera.width()), height(camera.height()), data(static_cast<std::size_t>(3) * width * height) {
    std::vector<GreyImage> channels;
    for (int k = 0; k < 3; ++k) {
      channels.emplace_back(width, height, static_cast<std::uint8_t>(background[k]));
      drawCoverage(seen, camera, static_cast<std::uint8_t>(object[k]), &channels.back());
    }
    for (std::size_t i = 0; i < data.size(); ++i) data[i] = channels[i % 3].data[i / 3];
  }
  ImageView view() const {
    return {data.data(), width, height, static_cast<std::size_t>(3) * width, PixelFormat::kRgb8};
  }
  std::uint8_t* at(int u, int v) { return &data[3 * (static_cast<std::size_t>(v) * width + u)]; }
};

VisionConfig coloured(double from_deg, double to_deg, SegmentationMethod method = SegmentationMethod::kCoverage) {
  VisionConfig config = testing::usualVision();
  config.threshold.reset();
  config.segmentation = method;
  ObjectColour colour;
  colour.hue_deg = {from_deg, to_deg};
  config.object = colour;
  return config;
}

VisionConfig shaded(ObjectShade shade) {
  VisionConfig config = testing::usualVision();
  config.object = shade;
  return config;
}

struct Errors {
  double centroid_px = 0.0, area = 0.0, alpha_deg = 0.0;
};

Errors errorsOf(const MomentFeatures& f, const Polygon& seen) {
  const std::vector<double> m = testing::polygonMoments(seen, 3), mu = testing::polygonCentredMoments(seen, 3);
  const double alpha = 0.5 * std::atan2(2.0 * mu[4], mu[3] - mu[5]);
  return {kFocal_px * std::hypot(f.xg - m[1] / m[0], f.yg - m[2] / m[0]), std::abs(f.area / m[0] - 1.0),
          std::abs(std::remainder(f.alpha - alpha, kPi)) * 180.0 / kPi};
}

std::vector<Polygon> views() {
  std::vector<Polygon> seen;
  for (int k = 0; k < 10; ++k)
    seen.push_back(
        testing::project(testing::blob(0.17), {0.011 * k - 0.05, 0.04 - 0.009 * k, 0.5, 0.61 * k, 0.0, 0.0}));
  return seen;
}

Errors worstOf(const VisionConfig& config, const Rgb& object, const Rgb& background) {
  const CameraIntrinsics camera = testing::testCamera();
  MomentExtractor extractor(camera, config);
  Errors worst;
  for (const Polygon& seen : views()) {
    const ColourImage image(seen, camera, object, background);
    const MomentFeatures f = extractor.process(image.view());
    EXPECT_TRUE(f.valid);
    if (!f.valid) continue;
    const Errors e = errorsOf(f, seen);
    worst = {std::max(worst.centroid_px, e.centroid_px), std::max(worst.area, e.area),
             std::max(worst.alpha_deg, e.alpha_deg)};
  }
  return worst;
}

void expectAccurate(const Errors& e, double times = 1.0) {
  EXPECT_LT(e.centroid_px, times * kCentroid_px);
  EXPECT_LT(e.area, times * kArea);
  EXPECT_LT(e.alpha_deg, times * kAlpha_deg);
}

TEST(ObjectColour, RedOnGreenOfEqualGreyIsAsAccurateAsBlackOnWhite) {
  expectAccurate(worstOf(shaded(ObjectShade::kDark), kBlack, kWhite));
  expectAccurate(worstOf(coloured(340, 20), kRed, kGreen));
  expectAccurate(worstOf(coloured(90, 150), kGreen, kRed));
  const CameraIntrinsics camera = testing::testCamera();
  const ColourImage image(views()[0], camera, kRed, kGreen);
  EXPECT_FALSE(MomentExtractor(camera, shaded(ObjectShade::kDark)).process(image.view()).target_visible);
}

TEST(ObjectColour, OtherPairsOfColoursAreAsAccurate) {
  constexpr double kLessChroma = 1.5;  // 115 to 160 levels apart instead of 217
  expectAccurate(worstOf(coloured(200, 260), kBlue, kWhite), kLessChroma);
  expectAccurate(worstOf(coloured(200, 260), kBlue, kBlack), kLessChroma);
  expectAccurate(worstOf(coloured(0, 40), {230, 120, 90}, {90, 160, 150}), kLessChroma);
}

TEST(ObjectColour, BinaryMethodsFindThePixelsThatAreCoveredByMoreThanAHalfOrHaveTheHue) {
  const CameraIntrinsics camera = testing::testCamera();
  const Polygon seen = views()[3];
  const ColourImage image(seen, camera, kRed, kGreen);
  const double px2 = testing::polygonMoments(seen, 0)[0] * kFocal_px * kFocal_px;
  for (const SegmentationMethod method :
       {SegmentationMethod::kFixed, SegmentationMethod::kOtsu, SegmentationMethod::kAdaptive}) {
    MomentExtractor extractor(camera, coloured(340, 20, method));
    const MomentFeatures f = extractor.process(image.view());
    ASSERT_TRUE(f.valid);
    EXPECT_TRUE(extractor.mask().edge.empty());
    EXPECT_FALSE(extractor.mask().soft_edges);
    // Half the rim is of another hue; the local mean is not in the middle between both.
    const double rim = method == SegmentationMethod::kFixed ? 0.06 : method == SegmentationMethod::kOtsu ? 0.01 : 0.03;
    EXPECT_NEAR(extractor.mask().area_px / px2, 1.0, rim);
    EXPECT_LT(errorsOf(f, seen).centroid_px, 0.1);
  }
}

TEST(ObjectColour, OtherColoursAndGreysAreNotTheTarget) {
  const CameraIntrinsics camera = testing::testCamera();
  const Polygon seen = views()[4];
  ColourImage image(seen, camera, kRed, kWhite);
  const Errors alone = errorsOf(MomentExtractor(camera, coloured(340, 20)).process(image.view()), seen);
  for (int v = 0; v < 240; ++v) {
    for (int u = 0; u < 320; ++u) {
      const Rgb colour = u < 30    ? kBlue
                         : u < 60  ? Rgb{255, 160, 0}
                         : v < 20  ? Rgb{90, 90, 90}
                         : v > 225 ? kGreen
                                   : kBlack;
      if (u < 60 || v < 20 || v > 225) std::copy(colour.begin(), colour.end(), image.at(u, v));
    }
  }
  const MomentFeatures f = MomentExtractor(camera, coloured(340, 20)).process(image.view());
  ASSERT_TRUE(f.valid);
  EXPECT_EQ(f.components, 1);
  EXPECT_NEAR(errorsOf(f, seen).area, alone.area, 1e-12);
  EXPECT_NEAR(errorsOf(f, seen).centroid_px, alone.centroid_px, 1e-9);
  EXPECT_FALSE(MomentExtractor(camera, coloured(280, 330)).process(image.view()).target_visible);
}

TEST(ObjectColour, ABlackAndWhiteBackgroundHasOneChroma) {
  const CameraIntrinsics camera = testing::testCamera();
  const Polygon seen = views()[2];
  const ColourImage on_white(seen, camera, kRed, kWhite), on_black(seen, camera, kRed, kBlack);
  ColourImage image = on_white;
  for (int v = 0; v < 240; ++v)
    for (int u = 0; u < 320; ++u)
      if ((u / 16 + v / 16) % 2 == 0)
        for (int k = 0; k < 3; ++k) image.at(u, v)[k] = on_black.data[3 * (static_cast<std::size_t>(v) * 320 + u) + k];
  const MomentFeatures f = MomentExtractor(camera, coloured(340, 20)).process(image.view());
  ASSERT_TRUE(f.valid);
  expectAccurate(errorsOf(f, seen));
}

TEST(ObjectColour, NoiseMovesTheCentroidAsInAGreyImage) {
  const CameraIntrinsics camera = testing::testCamera();
  std::mt19937 random(7);
  std::normal_distribution<double> noise(0.0, 3.0);
  double worst = 0.0;
  for (const Polygon& seen : views()) {
    ColourImage image(seen, camera, kRed, {120, 130, 120});
    for (std::uint8_t& value : image.data)
      value = static_cast<std::uint8_t>(std::clamp<long>(std::lround(value + noise(random)), 0, 255));
    const MomentFeatures f = MomentExtractor(camera, coloured(330, 30)).process(image.view());
    ASSERT_TRUE(f.valid);
    EXPECT_EQ(f.components, 1);
    worst = std::max(worst, errorsOf(f, seen).centroid_px);
  }
  EXPECT_LT(worst, 0.03);
}

TEST(ObjectColour, OfAScreenWithoutItNothingIsVisible) {
  const CameraIntrinsics camera = testing::testCamera();
  std::mt19937 random(3);
  for (const Rgb& ground : {kBlack, kWhite, kGreen, Rgb{128, 128, 128}, kRed}) {  // the last is nowhere bounded
    for (const SegmentationMethod method : {SegmentationMethod::kCoverage, SegmentationMethod::kOtsu}) {
      ColourImage image({}, camera, ground, ground);
      std::normal_distribution<double> noise(0.0, 3.0);
      for (std::uint8_t& value : image.data)
        value = static_cast<std::uint8_t>(std::clamp<long>(std::lround(value + noise(random)), 0, 255));
      EXPECT_FALSE(MomentExtractor(camera, coloured(340, 20, method)).process(image.view()).target_visible);
    }
  }
}

TEST(ObjectColour, ImagesOf16BitsAndOtherOrdersGiveTheSameMoments) {
  const CameraIntrinsics camera = testing::testCamera();
  const ColourImage image(views()[1], camera, kRed, kGreen);
  std::vector<std::uint16_t> deep(image.data.size());
  for (std::size_t i = 0; i < deep.size(); ++i)
    deep[i] = static_cast<std::uint16_t>(257 * image.data[i / 3 * 3 + 2 - i % 3]);
  const ImageView bgr16{reinterpret_cast<const std::uint8_t*>(deep.data()), 320, 240, 320 * 6, PixelFormat::kBgr16};
  const MomentFeatures a = MomentExtractor(camera, coloured(340, 20)).process(image.view());
  const MomentFeatures b = MomentExtractor(camera, coloured(340, 20)).process(bgr16);
  ASSERT_TRUE(a.valid);
  EXPECT_EQ(a.m, b.m);
}

TEST(ObjectColour, MonoImagesAreRefusedByTheirName) {
  const CameraIntrinsics camera = testing::testCamera();
  const std::vector<std::uint8_t> bytes(320 * 240 * 2, 90);
  MomentExtractor extractor(camera, coloured(340, 20));
  for (const auto& [name, format] :
       {std::pair("mono8", PixelFormat::kMono8), std::pair("mono16", PixelFormat::kMono16)}) {
    const ImageView view{bytes.data(), 320, 240, 640, format};
    const std::string text = testing::textOf<ShapeError>([&, &v = view] { extractor.process(v); });
    EXPECT_NE(text.find(name), std::string::npos) << text;
    EXPECT_NE(text.find("vision.object"), std::string::npos) << text;
  }
}

/** Blind pixels are neither of the object nor of what is around it. */
TEST(ObjectColour, AnObjectThatReachesIntoTheBlindAreaIsCut) {
  const CameraIntrinsics camera(200, 200, {60, 0, 99.5, 0, 60, 99.5, 0, 0, 1}, "equidistant", {0, 0, 0, 0});
  const double seen_px = 60.0 * CameraIntrinsics::kWidestAngle;
  MomentExtractor extractor(camera, coloured(340, 20));
  for (const double radius_px : {30.0, seen_px - 8.0}) {
    ColourImage image({}, camera, kGreen, kGreen);
    for (int v = 0; v < 200; ++v)
      for (int u = 0; u < 200; ++u)
        if (std::hypot(u - 99.5 - radius_px, v - 99.5) < 12.0) std::copy(kRed.begin(), kRed.end(), image.at(u, v));
    const MomentFeatures f = extractor.process(image.view());
    EXPECT_TRUE(f.target_visible);
    EXPECT_EQ(f.touches_border, radius_px > 50.0);
  }
}

}  // namespace
}  // namespace aras_visual_servo_camera::colour_test
