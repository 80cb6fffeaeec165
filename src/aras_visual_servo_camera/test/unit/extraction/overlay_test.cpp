// What is drawn over an image, and where; the colours of every format.
#include "aras_visual_servo_camera/extraction/overlay.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "coverage_image.hpp"

namespace aras_visual_servo_camera::overlay_test {
namespace {

using Rgb = std::array<std::uint8_t, 3>;

constexpr Rgb kGround{90, 90, 90}, kGreen{0, 255, 0}, kRed{255, 0, 0}, kYellow{255, 255, 0}, kMagenta{255, 0, 255};
constexpr int kReach_px = 20, kU = 160, kV = 120;  // of the axis; where the centroid is drawn
constexpr double kFocal_px = 195.05, kPi = 3.14159265358979323846;

/** Features of an object of 60 x 40 pixels about the middle of an image of one grey, and the picture of them. */
struct Drawn {
  Drawn() {
    mask.width_px = 320;
    mask.height_px = 240;
    for (int v = kV - 20; v < kV + 20; ++v) mask.spans.push_back({v, kU - 30, kU + 30});
    features.target_visible = true;
    features.xg = (kU - camera.cx()) / camera.fx();
    features.yg = (kV - camera.cy()) / camera.fy();
    features.area = std::pow(2.0 * kReach_px / kFocal_px, 2);
  }

  void draw() { bytes = drawOverlay(image.view(), mask, features, camera); }
  Rgb at(int u, int v) const {
    const std::uint8_t* pixel = bytes.data() + 3 * (static_cast<std::size_t>(v) * 320 + u);
    return {pixel[0], pixel[1], pixel[2]};
  }
  int count(const Rgb& colour) const {
    int n = 0;
    for (int v = 0; v < 240; ++v)
      for (int u = 0; u < 320; ++u) n += at(u, v) == colour;
    return n;
  }

  CameraIntrinsics camera = testing::testCamera();
  testing::GreyImage image{320, 240, kGround[0]};
  ObjectMask mask;
  MomentFeatures features;
  std::vector<std::uint8_t> bytes;
};

TEST(Overlay, WithoutATargetIsTheImage) {
  Drawn d;
  d.features.target_visible = false;
  d.draw();
  EXPECT_EQ(d.count(kGround), 320 * 240);
}

TEST(Overlay, HasTheContourInGreenAndTheCentroidInRed) {
  Drawn d;
  d.draw();
  EXPECT_EQ(d.count(kGreen), 2 * (60 + 40) - 4);
  for (const int u : {kU - 30, kU + 29})
    for (const int v : {kV - 20, kV + 19}) EXPECT_EQ(d.at(u, v), kGreen);
  EXPECT_EQ(d.at(kU, kV), kRed);
  EXPECT_EQ(d.at(kU + 10, kV), kGround);
  EXPECT_EQ(d.count(kYellow), 0) << "there is no angle";
}

TEST(Overlay, AxisIsAnArrowWhereItsDirectionIsResolved) {
  for (const bool has_reference : {false, true}) {
    for (const bool symmetric : {false, true}) {
      for (const double alpha : {0.0, 0.5 * kPi, kPi}) {
        Drawn d;
        d.features.alpha = alpha;
        d.features.has_reference = has_reference;
        d.features.symmetric = symmetric;
        d.draw();
        const int du = static_cast<int>(std::lround(10 * std::cos(alpha)));
        const int dv = static_cast<int>(std::lround(10 * std::sin(alpha)));
        EXPECT_EQ(d.at(kU + du, kV + dv), kYellow) << alpha;
        EXPECT_EQ(d.at(kU - du, kV - dv), has_reference && !symmetric ? kGround : kYellow) << alpha;
      }
    }
  }
}

TEST(Overlay, PointsAreMagentaAndNumbered) {
  Drawn d;
  for (const int u : {60, 260}) {
    d.features.point_x.push_back((u - d.camera.cx()) / d.camera.fx());
    d.features.point_y.push_back((50 - d.camera.cy()) / d.camera.fy());
  }
  d.draw();
  bool alike = true;
  int written = 0;
  for (int v = 35; v <= 46; ++v) {
    for (int u = 64; u < 76; ++u) {
      written += d.at(u, v) == kMagenta;
      alike = alike && d.at(u, v) == d.at(u + 200, v);
    }
  }
  EXPECT_EQ(d.at(60, 50), kMagenta);
  EXPECT_EQ(d.at(260, 50), kMagenta);
  EXPECT_GT(written, 5);
  EXPECT_FALSE(alike) << "1 and 2";
}

}  // namespace
}  // namespace aras_visual_servo_camera::overlay_test
