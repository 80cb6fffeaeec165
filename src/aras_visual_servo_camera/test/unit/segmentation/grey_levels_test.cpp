// The grey levels of object and background: estimated, given, and Otsu's threshold between them.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <random>
#include <utility>
#include <vector>

#include "aras_visual_servo_camera/segmentation/segmentation.hpp"
#include "fill.hpp"
#include "usual_vision.hpp"

namespace aras_visual_servo_camera::grey_levels_test {
namespace {

using testing::fill;
using testing::GreyImage;
using testing::kBackgroundGrey;
using testing::kObjectGrey;

std::array<int, 256> histogramOf(const GreyImage& image) {
  std::array<int, 256> h{};
  for (std::uint8_t g : image.data) ++h[g];
  return h;
}

TEST(GreyLevels, AreFoundWhateverTheShareOfTheObject) {
  constexpr double kLevel = 0.5;  // sigma 5 over 150 pixels and more: 0.4
  std::mt19937 random(3);
  for (int side : {12, 60, 200}) {
    GreyImage image(320, 240, kBackgroundGrey);
    fill(&image, 20, 20, side, side, kObjectGrey + 40);
    testing::addNoise(5.0, &random, &image);
    const auto levels = estimateGreyLevels(histogramOf(image), ObjectShade::kDark, 50, 25.0);
    ASSERT_TRUE(levels.has_value());
    EXPECT_NEAR(levels->object, kObjectGrey + 40, 4 * kLevel) << side;
    EXPECT_NEAR(levels->background, kBackgroundGrey, kLevel) << side;
  }
}

TEST(GreyLevels, AreExactInACleanImage) {
  constexpr double kEdgePixels = 0.05;  // levels: a few edge pixels fall into the window of 2 levels
  const GreyImage image = testing::coverageImage(testing::project(testing::blob(0.1), {0.0, 0.0, 0.5, 0.3, 0.0, 0.0}),
                                                 testing::testCamera());
  const auto levels = estimateGreyLevels(histogramOf(image), ObjectShade::kDark, 50, 25.0);
  ASSERT_TRUE(levels.has_value());
  EXPECT_NEAR(levels->object, kObjectGrey, kEdgePixels);
  EXPECT_NEAR(levels->background, kBackgroundGrey, kEdgePixels);
}

TEST(GreyLevels, NoiseAloneIsNotTwoLevels) {
  std::mt19937 random(4);
  GreyImage image(320, 240, 128);
  testing::addNoise(12.0, &random, &image);
  EXPECT_FALSE(estimateGreyLevels(histogramOf(image), ObjectShade::kDark, 50, 25.0).has_value());
}

TEST(GreyLevels, OfAnImageSmallerThanAnObjectAreNone) {
  std::array<int, 256> h{};
  h[20] = h[230] = 10;
  EXPECT_FALSE(estimateGreyLevels(h, ObjectShade::kDark, 50, 25.0).has_value());
  EXPECT_TRUE(estimateGreyLevels(h, ObjectShade::kDark, 15, 25.0).has_value());
}

/** Levels of these counts of the dark and of 70000 pixels of 230, and of the same upside down. */
void expectLevel(const std::vector<std::pair<int, int>>& counts, double level) {
  constexpr double kRounding = 1e-9;
  for (const ObjectShade shade : {ObjectShade::kDark, ObjectShade::kBright}) {
    const auto grey = [shade](int g) { return shade == ObjectShade::kDark ? g : 250 - g; };
    std::array<int, 256> h{};
    h[grey(230)] = 70000;
    for (const auto& [g, count] : counts) h[grey(g)] = count;
    const double wanted = shade == ObjectShade::kDark ? level : 250.0 - level;
    EXPECT_NEAR(estimateGreyLevels(h, shade, 50, 25.0).value().object, wanted, kRounding);
  }
}

TEST(GreyLevels, AreMeansOfAWindowThatNoEdgePixelReaches) {
  expectLevel({{20, 600}, {21, 400}}, 20.4);  // between two greys
  std::vector<std::pair<int, int>> noisy{{18, 400}, {19, 700}, {20, 1000}, {21, 700}, {22, 400}};
  for (int g = 30; g < 50; ++g) noisy.emplace_back(g, 50);
  expectLevel(noisy, 20.0);
}

TEST(GreyLevels, AreThoseOfMoreThanHalfTheLeastObject) {
  for (const ObjectShade shade : {ObjectShade::kDark, ObjectShade::kBright}) {
    for (const auto& [few, found] : {std::pair(25, false), std::pair(26, true)}) {
      std::array<int, 256> h{};
      h[20] = shade == ObjectShade::kDark ? few : 70000;
      h[230] = shade == ObjectShade::kDark ? 70000 : few;
      EXPECT_EQ(estimateGreyLevels(h, shade, 50, 25.0).has_value(), found) << few;
    }
  }
}

TEST(Otsu, SplitsTwoLevelsInTheMiddleOfTheGap) {
  std::array<int, 256> h{};
  h[20] = 500;
  h[230] = 70000;
  EXPECT_EQ(otsuThreshold(h).value(), (20 + 229) / 2);
  h[20] = 0;
  EXPECT_FALSE(otsuThreshold(h).has_value());
}

TEST(Otsu, TheGreyOfTheSplitItselfIsDark) {
  // Each grey from 51 to 150 is as frequent: the split is 100, the means of the classes are 75.5 and 125.5.
  GreyImage ramp(100, 40, 0);
  for (int u = 0; u < 100; ++u) fill(&ramp, u, 0, 1, 40, static_cast<std::uint8_t>(51 + u));
  ASSERT_EQ(otsuThreshold(histogramOf(ramp)).value(), 100);
  VisionConfig config = testing::usualVision();
  config.segmentation = SegmentationMethod::kOtsu;
  for (const ObjectShade shade : {ObjectShade::kDark, ObjectShade::kBright}) {
    config.object = shade;
    config.min_contrast = 49.9;
    EXPECT_EQ(Segmentation(config).process(ramp.view()).area_px, 50 * 40);
    config.min_contrast = 50.1;
    EXPECT_FALSE(Segmentation(config).process(ramp.view()).visible);
  }
}

TEST(Otsu, TheThresholdOfAnImageIsThatOfAllItsPixelsOnce) {
  VisionConfig config = testing::usualVision();
  config.segmentation = SegmentationMethod::kOtsu;
  // Of three greys the middle one goes to the one side or to the other, as a few pixels more or less decide.
  for (const int width : {33, 63, 64, 100, 163}) {
    int taken = 0, left = 0;
    for (int middle = 60; middle < 200; ++middle) {
      for (const int rows : {4, 11}) {
        GreyImage image(width, 40, kBackgroundGrey);
        fill(&image, 2, 5, width - 4, 10, kObjectGrey);
        fill(&image, 2, 15, width - 4, rows, static_cast<std::uint8_t>(middle));
        for (int v = 15; v < 15 + rows; v += 3) image.at(width - 4, v) = static_cast<std::uint8_t>(middle + 1);
        const double threshold = otsuThreshold(histogramOf(image)).value();
        const auto wanted = std::count_if(image.data.begin(), image.data.end(), [&](int g) { return g < threshold; });
        ASSERT_EQ(Segmentation(config).process(image.view()).area_px, wanted) << width << " " << middle << " " << rows;
        ++(wanted > 10 * (width - 4) ? taken : left);
      }
    }
    EXPECT_TRUE(taken > 20 && left > 20) << taken << " " << left;
  }
}

/** A square of 20 px, and beside it one pixel that is half covered. */
constexpr int kPartU = 120, kPartV = 105, kPartGrey = (kObjectGrey + kBackgroundGrey) / 2;

class GivenGreys : public ::testing::TestWithParam<ObjectShade> {
 protected:
  bool dark() const { return GetParam() == ObjectShade::kDark; }
  double object() const { return dark() ? kObjectGrey : kBackgroundGrey; }
  double background() const { return dark() ? kBackgroundGrey : kObjectGrey; }
  double sign() const { return dark() ? 1.0 : -1.0; }

  ObjectMask maskOf(std::optional<double> object_grey, std::optional<double> background_grey) const {
    GreyImage image(320, 240, static_cast<std::uint8_t>(background()));
    fill(&image, 100, 100, 20, 20, static_cast<std::uint8_t>(object()));
    image.at(kPartU, kPartV) = kPartGrey;
    VisionConfig config = testing::usualVision();
    config.object = GetParam();
    config.object_grey = object_grey;
    config.background_grey = background_grey;
    return Segmentation(config).process(image.view());
  }

  /** What the half covered pixel weighs; -1: nothing. */
  double partOf(std::optional<double> object_grey, std::optional<double> background_grey) const {
    const ObjectMask mask = maskOf(object_grey, background_grey);
    for (const EdgePixel& e : mask.edge)
      if (e.u == kPartU && e.v == kPartV) return e.weight;
    return -1.0;
  }

  double part(double object_grey, double background_grey) const {
    return (background_grey - kPartGrey) / (background_grey - object_grey);
  }
};
INSTANTIATE_TEST_SUITE_P(Shades, GivenGreys, ::testing::Values(ObjectShade::kDark, ObjectShade::kBright));

constexpr double kEstimate = 1e-3;  // one edge pixel in 400 within the window around a level moves it by less

TEST_P(GivenGreys, OneIsUsedAndTheOtherEstimated) {
  const double lighter = object() + 20.0 * sign(), nearer = background() - 20.0 * sign();
  EXPECT_NEAR(partOf({}, {}), part(object(), background()), kEstimate);
  EXPECT_NEAR(partOf(lighter, {}), part(lighter, background()), kEstimate);
  EXPECT_NEAR(partOf({}, nearer), part(object(), nearer), kEstimate);
  EXPECT_NEAR(partOf(lighter, nearer), part(lighter, nearer), kEstimate);
}

TEST_P(GivenGreys, OneThatIsTooNearToTheOtherLeavesNoObject) {
  const double least = testing::usualVision().min_contrast;
  EXPECT_FALSE(maskOf(background() - (least - 1.0) * sign(), {}).visible);
  EXPECT_TRUE(maskOf(background() - (least + 1.0) * sign(), {}).visible);
  EXPECT_FALSE(maskOf({}, object() + (least - 1.0) * sign()).visible);
  EXPECT_FALSE(maskOf(background() + 10.0 * sign(), {}).visible) << "on the wrong side of it";
}

}  // namespace
}  // namespace aras_visual_servo_camera::grey_levels_test
