#include <gtest/gtest.h>

#include <cmath>

#include "aras_visual_servo_camera/photometric/photometric_extractor.hpp"
#include "coverage_image.hpp"
#include "text_of.hpp"
#include "usual_vision.hpp"

// Numbers are held against brute force by test_photometric.py; here what memory and sizes are about, under sanitizers
// too.
namespace aras_visual_servo_camera::photometric_test {
namespace {

using testing::GreyImage;

GreyImage waves(int width, int height, double shift_px) {
  GreyImage image(width, height, 0);
  for (int v = 0; v < height; ++v)
    for (int u = 0; u < width; ++u)
      image.at(u, v) = static_cast<std::uint8_t>(
          std::lround(128.0 + 50.0 * std::sin(0.21 * (u - shift_px) + 0.05 * v) + 50.0 * std::cos(0.17 * v)));
  return image;
}

CameraIntrinsics cameraOf(int width, int height, bool distorted) {
  return CameraIntrinsics(width, height, {100, 0, 0.5 * width, 0, 100, 0.5 * height, 0, 0, 1}, "plumb_bob",
                          distorted ? std::vector<double>{-0.33, 0.117, 0.001, 0.0, 0.0} : std::vector<double>());
}

struct Case {
  int width, height, levels;
  bool distorted;
  Illumination illumination;
  Mapping mapping = Mapping::kNone;
};

class Photometric : public ::testing::TestWithParam<Case> {};

TEST_P(Photometric, SeesAShiftOfTheImageAtAnySize) {
  const Case c = GetParam();
  PhotometricConfig config = testing::usualPhotometric();
  config.levels = c.levels;
  config.illumination = c.illumination;
  config.mapping = c.mapping;
  PhotometricExtractor extractor(cameraOf(c.width, c.height, c.distorted), config);
  const GreyImage reference = waves(c.width, c.height, 0.0), shifted = waves(c.width, c.height, 1.5);
  extractor.setReference(reference.view(), 0.5);
  const PhotometricFeatures home = extractor.process(reference.view()), away = extractor.process(shifted.view());
  EXPECT_TRUE(home.valid && away.valid) << home.fault << away.fault;
  EXPECT_EQ(home.level, 0);
  EXPECT_EQ(home.rms, 0.0);
  EXPECT_GT(away.rms, 1.0);
  // The image moved to the right: the camera must go the same way.
  ASSERT_EQ(away.H.size(), 21u);
  ASSERT_EQ(away.b.size(), 6u);
  EXPECT_GT(away.motion_px, 0.1);
  EXPECT_GT(-away.b[0], 0.0);  // descends
}

INSTANTIATE_TEST_SUITE_P(Sizes, Photometric,
                         ::testing::Values(Case{160, 120, 1, false, Illumination::kConstant},
                                           Case{161, 119, 3, false, Illumination::kOffset},
                                           Case{97, 83, 2, true, Illumination::kGainAndOffset},
                                           Case{33, 31, 1, true, Illumination::kGainAndOffset},
                                           Case{97, 83, 2, true, Illumination::kGainAndOffset, Mapping::kPca},
                                           Case{161, 119, 3, false, Illumination::kOffset, Mapping::kDct},
                                           Case{97, 83, 1, true, Illumination::kOffset, Mapping::kMixture},
                                           Case{45, 43, 1, true, Illumination::kConstant, Mapping::kMixture},
                                           Case{161, 119, 2, false, Illumination::kConstant,
                                                Mapping::kMutualInformation}));

TEST(Photometric, PixelsThatNoRayReachesAreLeftOut) {
  // The lens polynomial folds over at r = 1: beyond, nothing reaches the pixels.
  const CameraIntrinsics folded(161, 161, {70, 0, 80, 0, 70, 80, 0, 0, 1}, "plumb_bob", {-0.3333, 0.0, 0.0, 0.0});
  PhotometricExtractor extractor(folded, testing::usualPhotometric());
  const GreyImage image = waves(161, 161, 0.0);
  extractor.setReference(image.view(), 0.5);
  const PhotometricFeatures features = extractor.process(waves(161, 161, 1.0).view());
  EXPECT_TRUE(features.valid) << features.fault;
  EXPECT_LT(features.pixels, 140 * 140);
  EXPECT_GT(features.pixels, 1000);
  for (double h : features.H) EXPECT_TRUE(std::isfinite(h));
}

TEST(Photometric, AReferenceThatAnotherCameraCannotUseIsToldAndComesBackWithItsOwn) {
  const CameraIntrinsics camera = cameraOf(160, 120, false);
  for (const double f : {50.0, 85.0, 130.0}) {  // far too coarse, beyond the border of the reference's image, too fine
    PhotometricExtractor extractor(camera, testing::usualPhotometric());
    const GreyImage image = waves(160, 120, 0.0);
    extractor.setReference(image.view(), 0.5);
    const PhotometricFeatures before = extractor.process(image.view());
    extractor.setIntrinsics(CameraIntrinsics(160, 120, {f, 0, 80, 0, f, 60, 0, 0, 1}, "", {}));
    const PhotometricFeatures without = extractor.process(image.view());
    EXPECT_FALSE(without.has_reference || without.valid) << f;
    EXPECT_NE(without.fault.find("teach it again"), std::string::npos) << without.fault;
    EXPECT_EQ(without.reference_hash, 0u);
    extractor.setIntrinsics(camera);
    const PhotometricFeatures after = extractor.process(image.view());
    EXPECT_TRUE(after.has_reference && after.valid) << after.fault;
    EXPECT_EQ(after.H, before.H);
    EXPECT_EQ(after.reference_hash, before.reference_hash);
  }
}

TEST(Photometric, APartOfTheSameCameraSeesTheSameReference) {
  PhotometricExtractor extractor(cameraOf(160, 120, false), testing::usualPhotometric());
  GreyImage image = waves(160, 120, 0.0);
  extractor.setReference(image.view(), 0.5);
  extractor.setIntrinsics(CameraIntrinsics(80, 60, {100, 0, 40, 0, 100, 30, 0, 0, 1}, "", {}));
  EXPECT_THROW(extractor.process(image.view()), ShapeError);
  GreyImage part(80, 60, 0);
  for (int v = 0; v < 60; ++v)
    for (int u = 0; u < 80; ++u) part.at(u, v) = image.at(u + 40, v + 30);
  const PhotometricFeatures features = extractor.process(part.view());
  EXPECT_TRUE(features.has_reference && features.valid) << features.fault;
  EXPECT_EQ(features.rms, 0.0);
}

TEST(Photometric, APlaneThatIsNotInFrontOfEveryPixelIsRefused) {
  PhotometricExtractor extractor(cameraOf(160, 120, false), testing::usualPhotometric());
  const GreyImage image = waves(160, 120, 0.0);
  EXPECT_EQ(testing::textOf<ParameterError>([&] { extractor.setReference(image.view(), Plane{0.5, 0.5, 1.0}); }), "");
  for (const Plane& plane : {Plane{2.0, 0.0, 1.0}, Plane{-2.0, 0.0, 1.0}, Plane{0.0, 3.0, 1.0}, Plane{0.0, -3.0, 1.0},
                             Plane{0.0, 0.0, std::nan("")}, Plane{0.0, 0.0, INFINITY}})
    EXPECT_EQ(testing::textOf<ParameterError>([&] { extractor.setReference(image.view(), plane); }),
              "photometric reference: found a plane that is not in front of every pixel, allowed 1/Z > 0")
        << plane.A << " " << plane.B << " " << plane.C;
  EXPECT_TRUE(extractor.process(image.view()).has_reference);
  EXPECT_EQ(extractor.features().z_star_m, 1.0);
}

}  // namespace
}  // namespace aras_visual_servo_camera::photometric_test
