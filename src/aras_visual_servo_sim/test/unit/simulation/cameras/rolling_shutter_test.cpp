// Each row of a rolling shutter against where things were when it was exposed.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <string>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "tools/pan_lift.hpp"

namespace aras_visual_servo_sim::rolling_shutter_test {
namespace {

constexpr double kDark = 20.0, kBright = 230.0, kHalf_m = 0.1;
constexpr double kExactAim = 0.02;   // [px] of a flat target, whose coverage is exact
constexpr double kSampledAim = 0.1;  // [px] of one that OpenGL samples at 1/8 px

/** A dark square of 0.2 m that moves below the pan-lift robot, half a metre from the camera. */
Simulation moving(const std::string& camera, const std::string& velocity_m_per_s, int height) {
  return fixture::panLift(
      "{gravity_m_s2: [0, 0, 0], cameras: [{name: camera, frame: eye_optical_frame, width: 320, height: " +
      std::to_string(height) + ", encoding: mono8, horizontal_fov_rad: 1.0, rate_hz: 20.0, " + camera +
      "}], scene: {background_rgb: [230, 230, 230], models: [{name: target, color_rgb: [20, 20, 20], "
      "outlines_m: [[[-0.1, -0.1], [0.1, -0.1], [0.1, 0.1], [-0.1, 0.1]]], "
      "motion: {type: constant_velocity, linear_m_per_s: " +
      velocity_m_per_s + "}}]}}");
}

double covered(const Image& image, int u, int v) { return (kBright - *image.pixel(u, v)) / (kBright - kDark); }

/** Where the target begins in a row [px]. */
double leftIn(const Image& image, int v) {
  double left = -0.5;
  for (int u = 0; u < image.width / 2; ++u) left += 1.0 - covered(image, u, v);
  return left;
}

/** The straight line through where the target begins in some rows, at row v. */
double leftEdgeAt(const Image& image, double v, int first, int end) {
  Eigen::Matrix2d sums = Eigen::Matrix2d::Zero();
  Eigen::Vector2d right = Eigen::Vector2d::Zero();
  for (int row = first; row < end; ++row) {
    const Eigen::Vector2d terms(1.0, row - v);
    sums += terms * terms.transpose();
    right += leftIn(image, row) * terms;
  }
  return sums.inverse().row(0) * right;
}

/** Where it begins in a column. */
double topIn(const Image& image, int u) {
  double top = -0.5;
  for (int v = 0; v < image.height / 2; ++v) top += 1.0 - covered(image, u, v);
  return top;
}

/** Pixel that a point of the target's frame has. */
Eigen::Vector2d pixelOf(const CameraModel& camera, const Pose& X_WC, const Pose& X_WM, double x, double y) {
  return camera.project(X_WC.inverse() * (X_WM * Eigen::Vector3d(x, y, 0.0))).value();
}

struct Drawn {
  std::string keys;
  double aim_px;
};

class RollingCorners : public ::testing::TestWithParam<Drawn> {};

TEST_P(RollingCorners, AreWhereTheClosedFormPutsThem) {
  constexpr double kRowTime = 5e-5;  // [s]
  constexpr int kHeight = 240;
  const double kAim = GetParam().aim_px;
  for (const double vy : {0.5, -0.5, 0.0}) {
    const Eigen::Vector3d speed(-0.7, vy, 0.0);
    Simulation simulation = moving(GetParam().keys + "sensor: {shot_noise: false, row_time_s: 5.0e-5}",
                                   "[-0.7, " + std::to_string(vy) + ", 0.0]", kHeight);
    simulation.stepToImage("camera");
    ASSERT_EQ(simulation.stepToImage("camera"), 50000000);
    const Image& image = simulation.render(0);
    const CameraModel& camera = simulation.cameras()[0].model();
    const Pose X_WC = simulation.cameraPose(0), X_WM = simulation.models().pose("target");
    // The upper left corner of the image: of the four the one with least u + v, all of them at the stamp.
    Eigen::Vector2d corner(1e9, 1e9);
    double x = 0.0, y = 0.0;
    for (const double cx : {-kHalf_m, kHalf_m}) {
      for (const double cy : {-kHalf_m, kHalf_m}) {
        const Eigen::Vector2d pixel = pixelOf(camera, X_WC, X_WM, cx, cy);
        if (pixel.sum() > corner.sum()) continue;
        corner = pixel;
        x = cx;
        y = cy;
      }
    }
    Pose later = X_WM;
    later.p += speed * 1e-3;
    const Eigen::Vector2d velocity =
        (pixelOf(camera, X_WC, later, x, y) - corner) / 1e-3;  // [px/s] the plane is parallel
    // Row v sees it at -(height - 1 - v) row_time: the row that it is in when that row is exposed.
    const double per_row = velocity.y() * kRowTime;
    const double v = (corner.y() - per_row * (kHeight - 1)) / (1.0 - per_row);
    const double u = corner.x() - velocity.x() * kRowTime * (kHeight - 1 - v);
    const int row = static_cast<int>(v), column = static_cast<int>(u);
    EXPECT_NEAR(leftEdgeAt(image, v, row + 10, row + 61), u, kAim) << "speed " << vy;
    EXPECT_NEAR(topIn(image, column + 15), v, kAim) << "speed " << vy;
    EXPECT_GT(std::abs(u - corner.x()), 1.0);  // far from where a global shutter has it
  }
}

INSTANTIATE_TEST_SUITE_P(Renderers, RollingCorners,
                         ::testing::Values(Drawn{"", kExactAim}, Drawn{"renderer: opengl, ", kExactAim},
                                           Drawn{"renderer: opengl, quality: high, exact_targets: false, ",
                                                 kSampledAim}));

TEST(RollingShutter, RowsSeeTheCameraWherePhysicsHadIt) {
  constexpr int kHeight = 40;  // one row a tick: no interpolation
  constexpr double kRounding = 0.51 / (kBright - kDark);
  Simulation simulation = moving("sensor: {shot_noise: false, row_time_s: 1.0e-3}", "[0, 0, 0]", kHeight);
  Simulation same = moving("sensor: {shot_noise: false, row_time_s: 1.0e-3}", "[0, 0, 0]", kHeight);
  for (Simulation* each : {&simulation, &same}) each->setControllerCommand("pan_controller", 0.3);
  simulation.stepToImage("camera");
  simulation.stepToImage("camera");
  const Image& image = simulation.render(0);
  const CameraModel& camera = simulation.cameras()[0].model();
  same.step(50 - (kHeight - 1));
  double turned = 0.0, first = 0.0;
  for (int v = 0; v < kHeight; ++v) {
    const Pose X_WC = same.cameraPose(0), X_WM = same.models().pose("target");
    // Where the row's middle meets the target's left side: a straight line in the image.
    std::vector<Eigen::Vector2d> ends;
    double expected = 1e9;
    for (const double side : {-kHalf_m, kHalf_m}) {
      for (const bool along_x : {true, false}) {
        const Eigen::Vector2d a = pixelOf(camera, X_WC, X_WM, along_x ? -kHalf_m : side, along_x ? side : -kHalf_m);
        const Eigen::Vector2d b = pixelOf(camera, X_WC, X_WM, along_x ? kHalf_m : side, along_x ? side : kHalf_m);
        if ((a.y() - v) * (b.y() - v) > 0.0) continue;
        expected = std::min(expected, a.x() + (v - a.y()) / (b.y() - a.y()) * (b.x() - a.x()));
      }
    }
    ASSERT_LT(expected, 1e9);
    EXPECT_NEAR(leftIn(image, v), expected, 4 * kRounding) << "row " << v;
    if (v == 0) first = expected;
    turned = std::max(turned, std::abs(expected - first));
    same.step(1);
  }
  EXPECT_GT(turned, 2.0);  // [px]
}

TEST(RollingShutter, ExposureBlursEachRowAboutItsOwnTime) {
  constexpr int kHeight = 60;
  constexpr double kRowTime = 1e-4, kExposure = 0.02;
  Simulation sharp = moving("sensor: {shot_noise: false, row_time_s: 1.0e-4}", "[0.6, 0, 0]", kHeight);
  Simulation blurred = moving("exposure_s: 0.02, exposure_samples: 40, sensor: {shot_noise: false, row_time_s: 1.0e-4}",
                              "[0.6, 0, 0]", kHeight);
  for (Simulation* each : {&sharp, &blurred}) {
    each->stepToImage("camera");
    each->stepToImage("camera");
    each->render(0);
  }
  const CameraModel& camera = sharp.cameras()[0].model();
  const double px_per_s = 0.6 / 0.5 * camera.fx();
  for (const int v : {0, 20, kHeight - 1}) {
    const double shift = leftIn(sharp.cameras()[0].image, v) - leftIn(blurred.cameras()[0].image, v);
    // The middle of the ramp is half an exposure older; its pixels are rounded.
    EXPECT_NEAR(std::abs(shift), 0.5 * kExposure * px_per_s, 0.02 + 0.5 * kExposure * px_per_s / 210.0) << v;
  }
  const double skew = leftIn(sharp.cameras()[0].image, kHeight - 1) - leftIn(sharp.cameras()[0].image, 0);
  EXPECT_NEAR(std::abs(skew), kRowTime * (kHeight - 1) * px_per_s, 0.02);
}

TEST(RollingShutter, NothingThatMovesIsAGlobalShutter) {
  Simulation rolling = moving("sensor: {shot_noise: false, row_time_s: 1.0e-4}", "[0, 0, 0]", 60);
  Simulation global = moving("sensor: {shot_noise: false}", "[0, 0, 0]", 60);
  EXPECT_EQ(fixture::hashOf(rolling, 3), fixture::hashOf(global, 3));
}

TEST(RollingShutter, SameBytesLateOrSavedOrSteppedOtherwise) {
  const std::string keys = "exposure_s: 0.004, exposure_samples: 2, sensor: {dark_noise_e: 20, row_time_s: 2.0e-4}";
  Simulation once = moving(keys, "[0.4, 0.2, 0]", 40), again = moving(keys, "[0.4, 0.2, 0]", 40);
  const std::string hash = fixture::hashOf(once, 4);
  for (int k = 0; k < 4; ++k) {
    while (!again.cameras()[0].frameDue(again.ticks())) again.step(1);
    again.takeFrame(0);
    again.render(0);
  }
  EXPECT_EQ(again.runHash(), hash);
  again.reset();
  again.step(90);  // in the middle of a frame's exposure
  const std::string state = again.saveState();
  const std::string next = fixture::hashOf(again, 2);
  again.restoreState(state);
  EXPECT_EQ(fixture::hashOf(again, 2), next);
  Simulation late = moving(keys + ", latency_s: 0.03", "[0.4, 0.2, 0]", 40);
  late.stepToImage("camera");
  late.stepToImage("camera");
  once.reset();
  once.stepToImage("camera");
  once.stepToImage("camera");
  EXPECT_EQ(late.render(0).data, once.render(0).data);
}

}  // namespace
}  // namespace aras_visual_servo_sim::rolling_shutter_test
