#include "aras_visual_servo_camera/segmentation/segmentation.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "fill.hpp"
#include "usual_vision.hpp"

namespace aras_visual_servo_camera::segmentation_test {
namespace {

using testing::fill;
using testing::GreyImage;
using testing::kBackgroundGrey;
using testing::kObjectGrey;

constexpr double kRounding = 1e-12;  // sums of at most 77 k weights
constexpr double kGreyStep = 1.0 / (kBackgroundGrey - kObjectGrey);

VisionConfig with(SegmentationMethod method) {
  VisionConfig config = testing::usualVision();
  config.segmentation = method;
  return config;
}

double weightOf(const ObjectMask& mask) {
  double sum = 0.0;
  for (const Span& s : mask.spans) sum += s.u_end - s.u_begin;
  for (const EdgePixel& e : mask.edge) sum += e.weight;
  return sum;
}

const std::vector<SegmentationMethod> kMethods{SegmentationMethod::kFixed, SegmentationMethod::kOtsu,
                                               SegmentationMethod::kAdaptive, SegmentationMethod::kCoverage};

class EveryMethod : public ::testing::TestWithParam<SegmentationMethod> {
 protected:
  ObjectMask run(const GreyImage& image) { return Segmentation(with(GetParam())).process(image.view()); }
};
INSTANTIATE_TEST_SUITE_P(Segmentation, EveryMethod, ::testing::ValuesIn(kMethods));

TEST_P(EveryMethod, FindsADarkRectangleOfWholePixels) {
  GreyImage image(320, 240, kBackgroundGrey);
  fill(&image, 100, 60, 40, 30, kObjectGrey);
  const ObjectMask mask = run(image);
  EXPECT_TRUE(mask.visible);
  EXPECT_FALSE(mask.touches_border);
  EXPECT_EQ(mask.components, 1);
  EXPECT_EQ(mask.area_px, 1200);
  EXPECT_NEAR(weightOf(mask), 1200.0, kRounding);
  EXPECT_DOUBLE_EQ(mask.u_px, 119.5);
  EXPECT_DOUBLE_EQ(mask.v_px, 74.5);
}

TEST_P(EveryMethod, FindsABrightObjectWhenToldTo) {
  GreyImage image(320, 240, kObjectGrey);
  fill(&image, 100, 60, 40, 30, kBackgroundGrey);
  VisionConfig config = with(GetParam());
  config.object = ObjectShade::kBright;
  const ObjectMask mask = Segmentation(config).process(image.view());
  EXPECT_EQ(mask.area_px, 1200);
  EXPECT_NEAR(weightOf(mask), 1200.0, kRounding);
}

TEST(Coverage, EstimatedGreysAreThoseBesideTheObjectWhereLightFallsOff) {
  GreyImage image(320, 240, 0);
  for (int v = 0; v < 240; ++v)
    for (int u = 0; u < 320; ++u) {
      const double light = 230.0 - 0.0012 * ((u - 160.0) * (u - 160.0) + (v - 120.0) * (v - 120.0)) * 1.5;
      const bool in = u > 150 && u < 190 && v >= 100 && v < 140, half = (u == 150 || u == 190) && v >= 100 && v < 140;
      fill(&image, u, v, 1, 1, static_cast<int>(std::lround(in ? 20.0 : half ? 0.5 * (20.0 + light) : light)));
    }
  VisionConfig config;
  config.segmentation = SegmentationMethod::kCoverage;
  config.object_grey = config.background_grey = std::nullopt;
  const ObjectMask mask = Segmentation(config).process(image.view());
  EXPECT_NEAR(weightOf(mask), 40.0 * 40.0, 0.01 * 40.0 * 4.0);  // a hundredth of a pixel along the sides
  EXPECT_NEAR(1.0 / mask.grey_step, 230.0 - 20.0, 5.0);
}

TEST_P(EveryMethod, EmptyViewHasNoTarget) {
  GreyImage image(320, 240, kBackgroundGrey);
  EXPECT_FALSE(run(image).visible);
  std::mt19937 random(5);
  testing::addNoise(4.0, &random, &image);
  const ObjectMask mask = run(image);
  EXPECT_FALSE(mask.visible);
  EXPECT_EQ(mask.components, 0);
}

TEST_P(EveryMethod, SpecksAreNeitherCountedNorChosen) {
  GreyImage image(320, 240, kBackgroundGrey);
  fill(&image, 10, 10, 7, 7, kObjectGrey);  // 49 pixels, one less than the default of min_area_px
  fill(&image, 150, 100, 30, 30, kObjectGrey);
  const ObjectMask mask = run(image);
  EXPECT_EQ(mask.components, 1);
  EXPECT_EQ(mask.area_px, 900);
}

TEST_P(EveryMethod, OfTwoObjectsTheLargerIsWeighedAlone) {
  GreyImage image(320, 240, kBackgroundGrey);
  fill(&image, 100, 100, 30, 30, kObjectGrey);
  fill(&image, 131, 100, 20, 20, kObjectGrey);  // one pixel of background between them
  const ObjectMask mask = run(image);
  EXPECT_EQ(mask.components, 2);
  EXPECT_EQ(mask.area_px, 900);
  EXPECT_NEAR(weightOf(mask), 900.0, kRounding);
}

TEST_P(EveryMethod, TouchingPixelsAtCornersAreOneObject) {
  GreyImage image(320, 240, kBackgroundGrey);
  fill(&image, 100, 100, 20, 20, kObjectGrey);
  fill(&image, 120, 120, 20, 20, kObjectGrey);
  const ObjectMask mask = run(image);
  EXPECT_EQ(mask.components, 1);
  EXPECT_EQ(mask.area_px, 800);
}

TEST_P(EveryMethod, ObjectCutByEachBorderSaysSo) {
  const std::vector<std::array<int, 4>> boxes{
      {0, 100, 30, 30}, {290, 100, 30, 30}, {100, 0, 30, 30}, {100, 210, 30, 30}};
  for (const auto& box : boxes) {
    GreyImage image(320, 240, kBackgroundGrey);
    fill(&image, box[0], box[1], box[2], box[3], kObjectGrey);
    const ObjectMask mask = run(image);
    EXPECT_TRUE(mask.visible);
    EXPECT_TRUE(mask.touches_border) << box[0] << ", " << box[1];
    EXPECT_NEAR(weightOf(mask), 900.0, kRounding);
  }
}

TEST_P(EveryMethod, ObjectOnePixelFromTheBorderIsWhole) {
  GreyImage image(320, 240, kBackgroundGrey);
  fill(&image, 1, 1, 30, 30, kObjectGrey);
  const ObjectMask mask = run(image);
  EXPECT_FALSE(mask.touches_border);
  EXPECT_NEAR(weightOf(mask), 900.0, kRounding);
}

TEST_P(EveryMethod, OddSizedImagesAndRingsAreHandled) {
  GreyImage image(61, 43, kBackgroundGrey);
  fill(&image, 20, 10, 20, 20, kObjectGrey);
  fill(&image, 25, 15, 10, 10, kBackgroundGrey);  // a hole
  const ObjectMask mask = run(image);
  EXPECT_EQ(mask.components, 1);
  EXPECT_NEAR(weightOf(mask), 300.0, kRounding);
}

TEST_P(EveryMethod, RenderedWeightsAddUpToTheWeights) {
  const GreyImage image = testing::coverageImage(testing::project(testing::blob(0.15), {0.0, 0.0, 0.5, 0.3, 0.0, 0.0}),
                                                 testing::testCamera());
  const ObjectMask mask = run(image);
  std::vector<std::uint8_t> rendered(320 * 240, 77);
  mask.render(rendered.data());
  const double sum = std::accumulate(rendered.begin(), rendered.end(), 0.0) / 255.0;
  // each edge pixel is rounded by at most half a level
  EXPECT_NEAR(sum, weightOf(mask), 0.5 / 255.0 * static_cast<double>(mask.edge.size()) + kRounding);
  EXPECT_GT(sum, 1000.0);
}

TEST(Segmentation, FullViewOfTheObjectTouchesTheBorder) {
  const GreyImage image(320, 240, kObjectGrey);
  for (VisionConfig config : {with(SegmentationMethod::kFixed), with(SegmentationMethod::kCoverage)}) {
    config.object_grey = kObjectGrey;
    config.background_grey = kBackgroundGrey;
    const ObjectMask mask = Segmentation(config).process(image.view());
    EXPECT_TRUE(mask.visible);
    EXPECT_TRUE(mask.touches_border);
    EXPECT_NEAR(weightOf(mask), 320.0 * 240.0, kRounding);
  }
}

TEST(Segmentation, OneLevelImagesHaveNoObjectWhenLevelsAreEstimated) {
  for (std::uint8_t grey : {0, 20, 128, 255}) {
    const GreyImage image(320, 240, grey);
    for (SegmentationMethod method : {SegmentationMethod::kOtsu, SegmentationMethod::kCoverage})
      EXPECT_FALSE(Segmentation(with(method)).process(image.view()).visible) << int{grey};
  }
}

TEST(Segmentation, OnePixelIsAnObjectWhenTheAreaFilterAllowsIt) {
  GreyImage image(320, 240, kBackgroundGrey);
  image.at(7, 9) = kObjectGrey;
  for (SegmentationMethod method : kMethods) {
    VisionConfig config = with(method);
    config.min_area_px = 1;
    const ObjectMask mask = Segmentation(config).process(image.view());
    EXPECT_EQ(mask.area_px, 1);
    EXPECT_NEAR(weightOf(mask), 1.0, kRounding);
  }
}

TEST(Segmentation, ThresholdItselfBelongsToTheBackground) {
  GreyImage image(320, 240, 200);
  fill(&image, 100, 100, 10, 10, 128);
  fill(&image, 110, 100, 10, 10, 127);
  VisionConfig config = with(SegmentationMethod::kFixed);
  config.threshold = 128;
  EXPECT_EQ(Segmentation(config).process(image.view()).area_px, 100);
  config.threshold = 128.5;
  EXPECT_EQ(Segmentation(config).process(image.view()).area_px, 200);
  config.threshold = 0;
  EXPECT_FALSE(Segmentation(config).process(image.view()).visible);
}

TEST(Segmentation, ABrightObjectDoesNotHaveTheThresholdEither) {
  GreyImage image(320, 240, 20);
  fill(&image, 100, 100, 10, 10, 128);
  fill(&image, 110, 100, 10, 10, 129);
  VisionConfig config = with(SegmentationMethod::kFixed);
  config.object = ObjectShade::kBright;
  config.threshold = 128;
  EXPECT_EQ(Segmentation(config).process(image.view()).area_px, 100);
  config.threshold = 127.5;
  EXPECT_EQ(Segmentation(config).process(image.view()).area_px, 200);
}

TEST(Segmentation, AnEdgePixelOfEachBorderThatIsCoveredByMoreThanATenthSaysThatTheObjectGoesOn) {
  for (int side = 0; side < 4; ++side) {
    for (const auto& [weight, touches] : {std::pair{0.03, false}, std::pair{0.3, true}, std::pair{0.8, true}}) {
      GreyImage image(320, 240, kBackgroundGrey);
      fill(&image, side == 1 ? 279 : 1, side == 3 ? 199 : 1, 40, 40, kObjectGrey);  // one pixel from its border
      const int u = side == 0 ? 0 : 319, v = side == 2 ? 0 : 239;
      const auto grey = static_cast<std::uint8_t>(std::lround(kBackgroundGrey - weight / kGreyStep));
      for (int k = 10; k < 20; ++k) {
        image.at(side < 2 ? u : 1 + k, side < 2 ? 1 + k : v) = grey;
      }
      EXPECT_EQ(Segmentation(testing::usualVision()).process(image.view()).touches_border, touches)
          << "side " << side << " weight " << weight;
    }
  }
}

TEST(Segmentation, CoverageWeighsAnEdgePixelByItsGrey) {
  GreyImage image(320, 240, kBackgroundGrey);
  fill(&image, 100, 100, 20, 20, kObjectGrey);
  image.at(99, 105) = 178;   // about a quarter covered
  image.at(120, 105) = 230;  // not at all
  const ObjectMask mask = Segmentation(testing::usualVision()).process(image.view());
  EXPECT_NEAR(weightOf(mask), 400.0 + (230 - 178) * kGreyStep,
              20 * kGreyStep * 0.01);  // levels within 0.01 of the truth
}

TEST(Segmentation, SmallSpecksBesideTheObjectDoNotWeigh) {
  GreyImage image(320, 240, kBackgroundGrey);
  fill(&image, 100, 100, 20, 20, kObjectGrey);
  image.at(121, 110) = kObjectGrey;  // one pixel of background between: within reach of the edge
  image.at(122, 110) = 125;
  EXPECT_NEAR(weightOf(Segmentation(testing::usualVision()).process(image.view())), 400.0, kRounding);
}

TEST(Segmentation, ForBlobsEveryObjectIsKeptAndNoSpeck) {
  GreyImage image(320, 240, kBackgroundGrey);
  fill(&image, 10, 10, 7, 7, kObjectGrey);  // one pixel too few
  fill(&image, 100, 100, 20, 20, kObjectGrey);
  fill(&image, 200, 120, 30, 30, kObjectGrey);
  VisionConfig config = testing::usualVision();
  Segmentation one(config);
  one.process(image.view());
  EXPECT_TRUE(one.objects().empty());
  config.points = PointSource::kBlobs;
  Segmentation all(config);
  EXPECT_FALSE(all.process(image.view()).visible) << "none of them is the target";
  ASSERT_EQ(all.objects().size(), 2u);
  EXPECT_EQ(all.objects()[0].area_px, 400);
  EXPECT_EQ(all.objects()[1].area_px, 900);
  EXPECT_NEAR(weightOf(all.objects()[1]), 900.0, kRounding);
}

TEST(Segmentation, NearestToPreviousFollowsTheObjectItChose) {
  VisionConfig config = testing::usualVision();
  config.component = ComponentChoice::kNearestToPrevious;
  Segmentation segmentation(config);
  GreyImage first(320, 240, kBackgroundGrey);
  fill(&first, 50, 50, 20, 20, kObjectGrey);
  EXPECT_EQ(segmentation.process(first.view()).area_px, 400);
  GreyImage second(320, 240, kBackgroundGrey);
  fill(&second, 55, 52, 20, 20, kObjectGrey);
  fill(&second, 200, 150, 60, 60, kObjectGrey);  // larger, but far away
  EXPECT_EQ(segmentation.process(second.view()).area_px, 400);
  segmentation.forgetPrevious();
  EXPECT_EQ(segmentation.process(second.view()).area_px, 3600);
}

TEST(Segmentation, AdaptiveFindsNothingAlongTheBordersOfAnImageOfOneGrey) {
  for (const ObjectShade shade : {ObjectShade::kDark, ObjectShade::kBright}) {
    VisionConfig config = with(SegmentationMethod::kAdaptive);
    config.object = shade;
    for (const std::uint8_t grey : {0, 150, 255})
      EXPECT_FALSE(Segmentation(config).process(GreyImage(320, 240, grey).view()).visible) << int{grey};
  }
}

TEST(Segmentation, AdaptiveThresholdCopesWithAGradientThatNoGlobalOneDoes) {
  GreyImage image(320, 240, 0);
  for (int v = 0; v < 240; ++v)
    for (int u = 0; u < 320; ++u) image.at(u, v) = static_cast<std::uint8_t>(80 + u / 2);  // 80 to 239
  for (int v = 100; v < 130; ++v)
    for (int u = 240; u < 270; ++u)
      image.at(u, v) = static_cast<std::uint8_t>(image.at(u, v) - 60);  // brighter than the left
  EXPECT_EQ(Segmentation(with(SegmentationMethod::kAdaptive)).process(image.view()).area_px, 900);
  EXPECT_NE(Segmentation(with(SegmentationMethod::kOtsu)).process(image.view()).area_px, 900);
}

}  // namespace
}  // namespace aras_visual_servo_camera::segmentation_test
