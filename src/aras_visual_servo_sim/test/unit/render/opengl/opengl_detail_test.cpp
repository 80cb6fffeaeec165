// What makes a large image cheap: fewer triangles, few taps, a library for each thread.
#include <gtest/gtest.h>

#include <memory>
#include <thread>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "opengl_tools.hpp"
#include "render/opengl/gl/osmesa_library.hpp"
#include "render/opengl/scene/picture_taps.hpp"

namespace aras_visual_servo_sim::testing::opengl_detail_test {
namespace {

CameraModel cameraOf(int width, int height) {
  CameraConfig config;
  config.width = width;
  config.height = height;
  config.horizontal_fov_rad = 1.2;
  config.encoding = "rgb8";
  return CameraModel(config);
}

const Pose kDown{{0.0, 0.0, 1.0}, Eigen::Quaterniond(0.0, 1.0, 0.0, 0.0)};

TEST(OpenGlDetail, ManyTrianglesLookLikeTheBodyTheyStandFor) {
  TriangleMesh many = *makeSphere(0.2, 400);
  many.round.reset();
  ASSERT_GT(many.triangles.size(), 100000u);
  Scene round;
  round.bodies.push_back(solid("floor", makeBox({3.0, 3.0, 0.02}), {180, 180, 180}, {0.0, 0.0, -0.3}));
  Light sun;
  sun.name = "sun";
  sun.type = Light::Type::kDirectional;
  sun.direction_W = {0.3, 0.2, -1.0};
  round.lighting.lights = {sun};
  round.lighting.shadows = false;  // those of a round body are those of 32 sides
  round.bodies.push_back(solid("ball", makeSphere(0.2), {200, 90, 40}, {0.05, 0.03, 0.0}));
  Scene cut = round;
  cut.bodies[1].shapes[0].mesh = std::make_shared<TriangleMesh>(many);
  const CameraModel camera = cameraOf(640, 480);
  const Image exact = renderOpenGl(camera, kDown, round), made = renderOpenGl(camera, kDown, cut);
  int apart = 0;
  for (std::size_t k = 0; k < exact.data.size(); ++k) apart += std::abs(int(exact.data[k]) - int(made.data[k])) > 8;
  EXPECT_LT(apart, 900);  // of 50 000 values on the ball: some of its rim
  EXPECT_LT(std::abs(differenceOf(exact, made).mean), 0.05);
}

/** Taps of a plane that is tilted against the image, in the image's four quarters of rows. */
std::vector<int> tapsOf(double tilt_rad) {
  const PinholeView view = PinholeView::of(cameraOf(320, 240));
  MeshPicture picture;
  MeshPart part;
  part.picture = &picture;
  part.normal = Eigen::Vector3f::UnitZ();
  Eigen::Matrix4d X_CS = Eigen::Matrix4d::Identity();
  X_CS.topLeftCorner<3, 3>() = Eigen::AngleAxisd(M_PI - tilt_rad, Eigen::Vector3d::UnitX()).toRotationMatrix();
  X_CS(2, 3) = 1.0;
  std::vector<int> taps;
  for (int quarter = 0; quarter < 4; ++quarter) {
    const PixelBox rows{0, 60 * quarter, 320, 60 * quarter + 60};
    taps.push_back(tapRowsOf(part, X_CS, view, rows, /*split=*/false).at(0).taps);
  }
  return taps;
}

TEST(OpenGlDetail, APictureSeenStraightOnTakesOneTapEverywhere) {
  EXPECT_EQ(tapsOf(0.0), (std::vector<int>{1, 1, 1, 1}));
  EXPECT_EQ(tapsOf(0.3), (std::vector<int>{1, 1, 1, 1}));
  EXPECT_EQ(tapsOf(0.7), (std::vector<int>{2, 2, 2, 2}));
  const std::vector<int> aslant = tapsOf(1.3);  // the horizon is in the image
  EXPECT_EQ(*std::max_element(aslant.begin(), aslant.end()), 16);
}

TEST(OpenGlDetail, ThreadsThatDrawAtOnceHaveALibraryEach) {
  std::shared_ptr<const OsmesaLibrary> mine;
  try {
    mine = osmesaOfThread();
  } catch (const RenderError& error) {
    GTEST_SKIP() << error.what();
  }
  EXPECT_EQ(osmesaOfThread(), mine);
  std::shared_ptr<const OsmesaLibrary> others;
  std::thread([&] { others = osmesaOfThread(); }).join();
  EXPECT_NE(others->create, mine->create);
  const auto* freed = others.get();
  others.reset();
  std::thread([&] { others = osmesaOfThread(); }).join();
  EXPECT_EQ(others.get(), freed);
}

}  // namespace
}  // namespace aras_visual_servo_sim::testing::opengl_detail_test
