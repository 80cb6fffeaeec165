// Blobs on the unit sphere: rays through a fisheye 200 degrees wide, also from beside and behind the camera.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "aras_visual_servo_camera/config/errors.hpp"
#include "aras_visual_servo_camera/extraction/moment_extractor.hpp"
#include "coverage_image.hpp"
#include "point_views.hpp"

namespace aras_visual_servo_camera::rays_test {
namespace {

using Vector = std::array<double, 3>;

constexpr double kDeg = 3.14159265358979323846 / 180.0;
constexpr double kRounding = 1e-12;
// Weights of 25 samples a pixel are off by 0.02 in the mean, over some 60 pixels of a rim: 0.003 px of 60 px a radian.
constexpr double kBlob_rad = 2e-4;

CameraIntrinsics fisheye(int size = 240, double focal_px = 60.0) {
  const double middle = 0.5 * (size - 1);
  return CameraIntrinsics(size, size, {focal_px, 0, middle, 0, focal_px, middle, 0, 0, 1}, "equidistant",
                          {0.02, -0.003, 0.0, 0.0});
}

Vector direction(double from_axis_deg, double about_deg) {
  const double a = from_axis_deg * kDeg, b = about_deg * kDeg;
  return {std::sin(a) * std::cos(b), std::sin(a) * std::sin(b), std::cos(a)};
}

/** Dark discs on the sphere, 5 degrees in radius, about these directions. */
testing::GreyImage discs(const CameraIntrinsics& camera, const std::vector<Vector>& about) {
  testing::GreyImage image(camera.width(), camera.height(), testing::kBackgroundGrey);
  constexpr int kSide = 5;
  for (int v = 0; v < image.height; ++v) {
    for (int u = 0; u < image.width; ++u) {
      int covered = 0;
      const auto middle = camera.rayOf(u, v);
      const bool near = std::any_of(about.begin(), about.end(), [&middle](const Vector& d) {
        return middle.x * d[0] + middle.y * d[1] + middle.z * d[2] > std::cos(8.0 * kDeg);
      });
      for (int k = 0; near && k < kSide * kSide; ++k) {
        const auto ray = camera.rayOf(u + (k % kSide + 0.5) / kSide - 0.5, v + (k / kSide + 0.5) / kSide - 0.5);
        for (const Vector& d : about)
          covered += ray.solid_angle > 0.0 && ray.x * d[0] + ray.y * d[1] + ray.z * d[2] > std::cos(5.0 * kDeg);
      }
      const double part = covered / double(kSide * kSide);
      image.at(u, v) = static_cast<std::uint8_t>(
          std::lround(testing::kBackgroundGrey + part * (testing::kObjectGrey - testing::kBackgroundGrey)));
    }
  }
  return image;
}

VisionConfig withRays(int count) {
  VisionConfig config = testing::withPoints(PointSource::kBlobs, count);
  config.rays = true;
  return config;
}

TEST(Rays, AreThoseOfTheLensModelBeyondARightAngle) {
  const CameraIntrinsics camera = fisheye();
  for (double theta_deg : {1.0, 45.0, 79.0, 89.9, 90.0, 95.0, 99.9}) {
    const double t = theta_deg * kDeg, r = 60.0 * t * (1.0 + t * t * (0.02 - 0.003 * t * t));
    const CameraIntrinsics::Ray ray = camera.rayOf(119.5 + r * std::cos(2.0), 119.5 + r * std::sin(2.0));
    const Vector truth = direction(theta_deg, 2.0 / kDeg);
    EXPECT_NEAR(ray.x, truth[0], kRounding);
    EXPECT_NEAR(ray.y, truth[1], kRounding);
    EXPECT_NEAR(ray.z, truth[2], kRounding);
  }
  EXPECT_EQ(camera.rayOf(119.5 + 60.0 * 1.95, 119.5).solid_angle, 0.0);  // 105 degrees and more
  EXPECT_EQ(camera.rayOf(119.5, 119.5).z, 1.0);
}

TEST(Rays, SolidAnglesAddUpToThoseOfTheView) {
  double cap = 0.0;
  const CameraIntrinsics camera = fisheye();
  for (int v = 0; v < 240; ++v)
    for (int u = 0; u < 240; ++u)
      if (camera.rayOf(u, v).z > std::cos(95.0 * kDeg)) cap += camera.rayOf(u, v).solid_angle;
  EXPECT_NEAR(cap / (2.0 * 3.14159265358979 * (1.0 - std::cos(95.0 * kDeg))), 1.0, 2e-3);  // stairs along the rim
  const CameraIntrinsics plain = testing::testCamera(true);
  const auto at = plain.undistort(30.0, 20.0);
  const auto ray = plain.rayOf(30.0, 20.0);
  EXPECT_NEAR(ray.x / ray.z, at.x, kRounding);
  EXPECT_NEAR(ray.y / ray.z, at.y, kRounding);
}

TEST(Rays, BlobsBesideAndBehindTheCameraAreFollowedInTheOrderOfTheGoal) {
  const CameraIntrinsics camera = fisheye();
  MomentExtractor extractor(camera, withRays(4));
  const std::vector<Vector> goal{direction(90, 10), direction(88, 100), direction(91, 200), direction(60, 290)};
  const MomentFeatures first = extractor.process(discs(camera, goal).view(), 1);
  ASSERT_TRUE(first.valid && first.target_visible);
  EXPECT_TRUE(first.point_x.empty() && first.m.empty());  // no plane of the image shows them all
  extractor.teach(1, 0.5);
  for (double turn_deg : {0.0, 8.0, 16.0, 24.0}) {
    const std::vector<Vector> here{direction(91, 10 + turn_deg), direction(89, 100 + turn_deg),
                                   direction(91, 200 + turn_deg), direction(60, 290 + turn_deg)};
    const MomentFeatures& seen = extractor.process(discs(camera, here).view(), 2);
    ASSERT_EQ(seen.ray_x.size(), 4u) << turn_deg;
    EXPECT_TRUE(seen.valid && seen.has_reference);
    EXPECT_EQ(seen.reference_stamp_ns, 1);
    // the order is that of the first view: whichever it began with, all four are the same turn on
    const auto shift = [&] {
      for (std::size_t s = 0; s < 4; ++s)
        if (first.ray_x[0] * goal[s][0] + first.ray_y[0] * goal[s][1] + first.ray_z[0] * goal[s][2] > 0.99) return s;
      return std::size_t{9};
    }();
    ASSERT_LT(shift, 4u);
    for (std::size_t k = 0; k < 4; ++k) {
      const Vector& truth = here[(k + shift) % 4];
      const double off = std::hypot(seen.ray_x[k] - truth[0], seen.ray_y[k] - truth[1], seen.ray_z[k] - truth[2]);
      EXPECT_LT(off, kBlob_rad) << turn_deg << ", " << k;
    }
  }
}

TEST(Rays, BlobsBeforeTheCameraHaveCoordinatesAndMomentsToo) {
  const CameraIntrinsics camera = fisheye();
  MomentExtractor extractor(camera, withRays(3));
  const MomentFeatures& seen =
      extractor.process(discs(camera, {direction(30, 10), direction(40, 130), direction(50, 250)}).view());
  ASSERT_TRUE(seen.valid);
  ASSERT_EQ(seen.point_x.size(), 3u);
  for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(seen.point_x[k], seen.ray_x[k] / seen.ray_z[k], kRounding);
  EXPECT_GT(seen.area, 0.0);
}

TEST(Rays, MoreBlobsThanWantedNeedToBeClearlySmaller) {
  const CameraIntrinsics camera = fisheye();
  MomentExtractor extractor(camera, withRays(2));
  const std::vector<Vector> two{direction(60, 10), direction(60, 130)};
  testing::GreyImage image = discs(camera, two);
  for (int v = 118; v < 126; ++v)
    for (int u = 118; u < 126; ++u) image.at(u, v) = testing::kObjectGrey;  // 64 pixels of some hundred
  const MomentFeatures& seen = extractor.process(image.view());
  EXPECT_EQ(seen.components, 3);
  ASSERT_EQ(seen.ray_x.size(), 2u);
  for (std::size_t k = 0; k < 2; ++k) {
    const auto near = [&](const Vector& d) {
      return seen.ray_x[k] * d[0] + seen.ray_y[k] * d[1] + seen.ray_z[k] * d[2] > 0.9999;
    };
    EXPECT_TRUE(near(two[0]) || near(two[1]));
  }
  EXPECT_FALSE(extractor.process(discs(camera, {two[0], two[1], direction(60, 250)}).view()).valid) << "equal ones";
}

TEST(Rays, OfAReferenceAreAsManyAsAskedFor) {
  const CameraIntrinsics camera = fisheye();
  MomentExtractor extractor(camera, withRays(2));
  const MomentFeatures whole = extractor.process(discs(camera, {direction(40, 10), direction(90, 130)}).view());
  ASSERT_TRUE(whole.valid);
  for (std::vector<double> MomentFeatures::*values :
       {&MomentFeatures::ray_x, &MomentFeatures::ray_y, &MomentFeatures::ray_z}) {
    MomentFeatures f = whole;
    (f.*values).pop_back();
    EXPECT_THROW(extractor.setReference(0.5, f), ShapeError);
  }
  extractor.setReference(0.5, whole);
}

TEST(Rays, OfABlobInTheMiddleIsTheAxis) {
  const CameraIntrinsics camera(241, 241, {60, 0, 120, 0, 60, 120, 0, 0, 1}, "equidistant", {0.02, -0.003, 0.0, 0.0});
  MomentExtractor extractor(camera, withRays(1));
  testing::GreyImage image(241, 241, testing::kBackgroundGrey);
  for (int v = 114; v <= 126; ++v)
    for (int u = 114; u <= 126; ++u) image.at(u, v) = testing::kObjectGrey;
  const MomentFeatures& seen = extractor.process(image.view(), 1);
  ASSERT_EQ(seen.ray_z.size(), 1u);
  EXPECT_NEAR(seen.ray_z[0], 1.0, kRounding);
  EXPECT_NEAR(seen.point_x[0], 0.0, kRounding);
  extractor.teach(1, 0.5);
  EXPECT_TRUE(extractor.process(image.view(), 2).valid);
}

TEST(Rays, WithoutThemABlobBesideTheCameraIsNoPoint) {
  const CameraIntrinsics camera = fisheye();
  MomentExtractor extractor(camera, testing::withPoints(PointSource::kBlobs, 2));
  EXPECT_FALSE(extractor.process(discs(camera, {direction(90, 10), direction(40, 130)}).view()).valid);
}

}  // namespace
}  // namespace aras_visual_servo_camera::rays_test
