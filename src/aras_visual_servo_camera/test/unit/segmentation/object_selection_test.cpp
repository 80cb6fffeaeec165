// Which of several objects is the target: continuity, hysteresis, similarity, and saying so where it is not clear.
#include <gtest/gtest.h>

#include <cmath>

#include "aras_visual_servo_camera/config/errors.hpp"
#include "aras_visual_servo_camera/extraction/moment_extractor.hpp"
#include "fill.hpp"
#include "usual_vision.hpp"

namespace aras_visual_servo_camera::object_selection_test {
namespace {

using testing::GreyImage;
using testing::kBackgroundGrey;
using testing::kObjectGrey;
using testing::Polygon;

constexpr double kDeg = 3.14159265358979323846 / 180.0;

/** An empty image to draw on. */
struct Scene {
  GreyImage image{320, 240, kBackgroundGrey};

  Scene& square(double u, double v, double side = 30.0) { return box(u, v, side, side); }
  Scene& box(double u, double v, double width, double height) {
    for (int row = 0; row < 240; ++row)
      for (int col = 0; col < 320; ++col)
        if (std::abs(col - u) <= 0.5 * width && std::abs(row - v) <= 0.5 * height) image.at(col, row) = kObjectGrey;
    return *this;
  }
  Scene& outline(const Polygon& shape, double x_m, double y_m, double yaw, double tilt = 0.0) {
    const CameraIntrinsics camera = testing::testCamera();
    testing::drawCoverage(testing::project(shape, {x_m, y_m, 0.5, yaw, tilt, 0.0}), camera, kObjectGrey, &image);
    return *this;
  }
};

VisionConfig choosing(ComponentChoice component) {
  VisionConfig config = testing::usualVision();
  config.component = component;
  return config;
}

/** Column of the object taken; -1: none. */
double columnOf(Segmentation* segmentation, const Scene& scene) {
  const ObjectMask& mask = segmentation->process(scene.image.view());
  return mask.visible ? std::round(mask.u_px) : -1.0;
}

TEST(Selection, TwoEqualObjectsAreAmbiguousAndGiveNoNumbers) {
  for (const ComponentChoice choice :
       {ComponentChoice::kLargest, ComponentChoice::kNearestToPrevious, ComponentChoice::kMostSimilar}) {
    MomentExtractor extractor(testing::testCamera(), choosing(choice));
    const Scene scene = Scene().box(80, 100, 40, 30).box(200, 100, 40, 30);
    const MomentFeatures& f = extractor.process(scene.image.view());
    EXPECT_TRUE(f.ambiguous);
    EXPECT_FALSE(f.target_visible);
    EXPECT_FALSE(f.valid);
    EXPECT_TRUE(std::isnan(f.area) && f.m.empty());
    EXPECT_EQ(f.components, 2);
    EXPECT_THROW(extractor.setReference(0.5, f), DegenerateFeature);
    EXPECT_FALSE(extractor.process(Scene().box(80, 100, 40, 30).image.view()).ambiguous);
    EXPECT_TRUE(extractor.features().valid);
  }
}

TEST(Selection, TheOneLeftIsNotTakenForTheOneThatLeft) {
  for (const ComponentChoice choice : {ComponentChoice::kLargest, ComponentChoice::kNearestToPrevious}) {
    Segmentation segmentation(choosing(choice));
    EXPECT_EQ(columnOf(&segmentation, Scene().square(80, 100)), 80.0);
    for (int u = 80; u > -20; u -= 5) {  // it leaves on the left
      const double found = columnOf(&segmentation, Scene().square(u, 100).square(200, 100));
      EXPECT_LT(found, 90.0) << u;
    }
    for (int k = 0; k < 20; ++k) EXPECT_EQ(columnOf(&segmentation, Scene().square(200 - k, 100)), -1.0) << k;
    for (int u = -10; u < 60; u += 5) {  // and comes back
      const double found = columnOf(&segmentation, Scene().square(u, 100).square(181, 100));
      EXPECT_LT(found, 70.0) << u;
    }
    EXPECT_EQ(columnOf(&segmentation, Scene().square(60, 100).square(181, 100)), 60.0);
  }
}

TEST(Selection, CrossingObjectsAreAmbiguousUntilTheyCanBeTold) {
  Segmentation equal{testing::usualVision()};
  bool was_ambiguous = false;
  for (int k = 0; k <= 60; ++k) {
    const double a = 60.0 + 2.0 * k, b = 240.0 - 2.0 * k;
    const Scene scene = k == 0 ? Scene().square(a, 100) : Scene().square(a, 100).square(b, 112);
    const double found = columnOf(&equal, scene);
    was_ambiguous |= equal.process(scene.image.view()).ambiguous;
    EXPECT_EQ(found, was_ambiguous ? -1.0 : a) << k << ": apart again, but which is which?";
  }
  EXPECT_TRUE(was_ambiguous);

  Segmentation told{testing::usualVision()};
  double last = 0.0;
  for (int k = 0; k <= 60; ++k)
    last = columnOf(&told, Scene().square(60.0 + 2.0 * k, 100, 36).square(240.0 - 2.0 * k, 112, 24));
  EXPECT_EQ(last, 180.0) << "the larger one";
}

TEST(Selection, AtRatioOneTheLargestIsTakenAtOnce) {
  VisionConfig config = testing::usualVision();
  config.switch_ratio = 1.0;
  config.switch_images = 1;
  Segmentation segmentation(config);
  EXPECT_EQ(columnOf(&segmentation, Scene().square(80, 100, 30)), 80.0);
  EXPECT_EQ(columnOf(&segmentation, Scene().square(80, 100, 30).square(220, 100, 33)), 220.0);
  EXPECT_EQ(columnOf(&segmentation, Scene().square(80, 100, 30).square(220, 100, 30)), 220.0) << "no better";
}

TEST(Selection, MostSimilarFindsTheReferencesShapeAmongLargerOnes) {
  MomentExtractor extractor(testing::testCamera(), choosing(ComponentChoice::kMostSimilar));
  const Polygon ell{{-0.03, -0.03}, {-0.01, -0.03}, {-0.01, 0.01}, {0.02, 0.01}, {0.02, 0.03}, {-0.03, 0.03}};
  const Polygon disc = testing::ellipse(0.04, 0.04, 0.0, {0.0, 0.0}, 48), slab = testing::rectangle(0.1, 0.05);
  extractor.setReference(0.5, extractor.process(Scene().outline(ell, 0.0, 0.0, 0.0).image.view()));
  for (int degrees = 0; degrees < 360; degrees += 30) {
    extractor.forgetPrevious();
    const Scene scene = Scene()
                            .outline(disc, -0.15, 0.1, 0.0, 0.4)
                            .outline(slab, 0.1, -0.1, degrees * kDeg, 0.4)
                            .outline(ell, 0.12, 0.08, degrees * kDeg, 0.4);
    const MomentFeatures& f = extractor.process(scene.image.view());
    EXPECT_FALSE(f.ambiguous) << degrees;
    EXPECT_GT(f.xg, 0.1);
    EXPECT_GT(f.yg, 0.05) << degrees;
  }
  extractor.forgetPrevious();
  const Scene without = Scene().outline(testing::rectangle(0.1, 0.02), 0.1, -0.1, 0.3);
  EXPECT_FALSE(extractor.process(without.image.view()).target_visible) << "a slab is no L, even alone";
  extractor.forgetPrevious();
  const MomentFeatures two =
      extractor.process(Scene().outline(ell, -0.1, 0.0, 1.0).outline(ell, 0.1, 0.0, 2.0).image.view());
  EXPECT_TRUE(two.ambiguous) << "two equal ones";
}

TEST(Selection, AFlickeringObjectIsKeptDownToTheLowerThreshold) {
  VisionConfig config = testing::usualVision();
  config.min_area_px = 100;
  const auto visible = [](Segmentation* s, double side) { return columnOf(s, Scene().square(80, 100, side)) >= 0.0; };
  Segmentation plain(config);
  EXPECT_TRUE(visible(&plain, 10));  // 11 x 11 pixels
  EXPECT_FALSE(visible(&plain, 8));  // 9 x 9
  config.lost_area_px = 50;
  Segmentation kept(config);
  EXPECT_FALSE(visible(&kept, 8)) << "too small to begin with";
  EXPECT_TRUE(visible(&kept, 10));
  EXPECT_TRUE(visible(&kept, 8));
  EXPECT_TRUE(visible(&kept, 10));
  EXPECT_FALSE(visible(&kept, 6));  // 7 x 7
}

TEST(Selection, AnObjectAtABorderCountsAsCutUntilItIsClearOfTheMargin) {
  VisionConfig config = testing::usualVision();
  config.border_margin_px = 5;
  for (int side = 0; side < 4; ++side) {
    MomentExtractor extractor(testing::testCamera(), config);
    const auto valid = [&](int away_px) {  // so many pixels are between the object and this border
      const int u = side == 0 ? away_px : side == 1 ? 320 - 60 - away_px : 130;
      const int v = side == 2 ? away_px : side == 3 ? 240 - 30 - away_px : 100;
      Scene scene;
      testing::fill(&scene.image, u, v, 60, 30, kObjectGrey);
      return extractor.process(scene.image.view()).valid;
    };
    EXPECT_TRUE(valid(2)) << side << ": near the border, but never cut";
    EXPECT_FALSE(valid(0)) << side;
    EXPECT_FALSE(valid(2)) << side;
    EXPECT_FALSE(valid(4)) << side;
    EXPECT_TRUE(valid(5)) << side;
    EXPECT_TRUE(valid(2)) << side;
  }
}

// Nothing throws, nothing is valid that has no orientation or is cut, whatever is in view.
TEST(Selection, DegenerateShapesAreFlagged) {
  VisionConfig config = choosing(ComponentChoice::kMostSimilar);
  config.min_area_px = 1;
  MomentExtractor extractor(testing::testCamera(), config);
  extractor.setReference(0.5, extractor.process(Scene().box(100, 100, 60, 30).image.view()));
  extractor.forgetPrevious();
  Scene pixel, line;
  pixel.image.at(50, 50) = kObjectGrey;
  for (int u = 40; u < 90; ++u) line.image.at(u, 60) = kObjectGrey;
  const Scene disc = Scene().outline(testing::ellipse(0.05, 0.05, 0.0, {0.0, 0.0}, 96), 0.0, 0.0, 0.0);
  EXPECT_FALSE(extractor.process(pixel.image.view()).valid);
  EXPECT_FALSE(extractor.process(disc.image.view()).valid);
  EXPECT_NO_THROW(extractor.process(line.image.view()));
  EXPECT_NO_THROW(extractor.process(Scene().image.view()));
  EXPECT_FALSE(extractor.features().valid);
}

}  // namespace
}  // namespace aras_visual_servo_camera::object_selection_test
