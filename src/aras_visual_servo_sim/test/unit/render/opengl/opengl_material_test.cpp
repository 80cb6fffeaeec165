// Surfaces: pictures near, far and aslant, backs.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "light_tools.hpp"

namespace aras_visual_servo_sim::testing::opengl_material_test {
namespace {

/** Stripes of black and white, each two texels wide, that run along t. */
TexturePtr stripes(int side) {
  std::vector<std::uint8_t> rgb;
  for (int k = 0; k < side * side; ++k) rgb.insert(rgb.end(), 3, k % 4 < 2 ? 255 : 0);
  return std::make_shared<Texture>("stripes", side, side, rgb);
}

/** A square of 2 a m in z = 0 about the origin with a picture. */
MeshPtr plate(double a, const TexturePtr& texture) {
  const auto s = static_cast<float>(a);
  auto mesh = std::make_shared<TriangleMesh>();
  mesh->points = {{-s, -s, 0}, {s, -s, 0}, {s, s, 0}, {-s, s, 0}};
  mesh->normals.assign(4, Eigen::Vector3f::UnitZ());
  mesh->triangles = {{0, 1, 2}, {0, 2, 3}};
  mesh->texture_coordinates = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};
  mesh->pictures = {{texture}};
  mesh->picture_of = {0, 0};
  mesh->finish();
  return mesh;
}

Scene sceneOf(const MeshPtr& mesh, double ambient = 1.0) {
  Scene scene;
  scene.background = {0, 0, 0};
  scene.lighting.ambient.setConstant(ambient);
  scene.lighting.lights = {lamp(Light::Type::kDirectional, 0.0)};
  scene.bodies.push_back(solid("plate", mesh, {255, 255, 255}, {0.0, 0.0, 0.0}));
  return scene;
}

/** Least and greatest red of a part of a row. */
std::pair<int, int> spread(const Image& image, int u0, int u1, int v) {
  int low = 255, high = 0;
  for (int u = u0; u < u1; ++u) {
    low = std::min(low, int(image.pixel(u, v)[0]));
    high = std::max(high, int(image.pixel(u, v)[0]));
  }
  return {low, high};
}

TEST(OpenGlMaterial, PicturesFarAwayAreTheirMean) {
  CameraConfig config = rgbConfig();
  config.sampling = "center";  // nothing but the mip map can make means
  const Scene scene = sceneOf(plate(1.0, stripes(1024)));
  // A stripe is 4 mm wide, a pixel 21 mm and, from near by, 0.5 mm.
  const Image far = renderOpenGl(CameraModel(config), lookingDown({0.0, 0.0, 4.0}), scene);
  const auto [low, high] = spread(far, 130, 190, 120);
  EXPECT_GT(low, 117);
  EXPECT_LT(high, 138);
  const Image near = renderOpenGl(CameraModel(config), lookingDown({0.0, 0.0, 0.1}), scene);
  const auto [dark, bright] = spread(near, 130, 190, 120);
  EXPECT_LT(dark, 20);
  EXPECT_GT(bright, 235);
}

TEST(OpenGlMaterial, StripesAlongTheViewStaySharpAslant) {
  // Seen along y at 3 degrees above the plate, a pixel covers twenty times more of it along y than along x.
  const CameraModel camera(rgbConfig());
  const Eigen::Vector3d from(0.0, -1.0, 0.05), to(0.0, 0.0, 0.0);
  Eigen::Matrix3d R;
  R.col(2) = (to - from).normalized();
  R.col(0) = Eigen::Vector3d::UnitX();
  R.col(1) = R.col(2).cross(R.col(0));
  const Scene scene = sceneOf(plate(1.0, stripes(128)));  // 31 mm each; a pixel is 5 mm wide there
  const Image image = renderOpenGl(camera, {from, Eigen::Quaterniond(R)}, scene);
  const auto [dark, bright] = spread(image, 120, 200, 120);
  EXPECT_LT(dark, 50);
  EXPECT_GT(bright, 205);
}

/** Mean over squares of pixels. */
std::vector<double> meansOf(const Image& image, int side) {
  std::vector<double> means(image.data.size() / std::size_t(side * side), 0.0);
  const int width = image.width / side;
  for (int v = 0; v < image.height; ++v) {
    for (int u = 0; u < image.width; ++u) {
      for (int c = 0; c < 3; ++c) {
        means[std::size_t(v / side * width + u / side) * 3 + c] += double(image.pixel(u, v)[c]) / (side * side);
      }
    }
  }
  return means;
}

TEST(OpenGlMaterial, PicturesAslantAreNearTheMeanOverEachPixel) {
  // Squares of four texels on a plate that reaches from below the camera to near the horizon, straight and turned:
  // strips of all lengths. Mesa's own anisotropic filter of 16 is 5.8 and 8.9 grey levels off.
  constexpr double kMost = 3.0;
  std::vector<std::uint8_t> rgb;
  for (int k = 0; k < 512 * 512; ++k) {
    const auto block = static_cast<std::uint32_t>(k / 512 / 4 * 128 + k % 512 / 4);
    rgb.insert(rgb.end(), 3, static_cast<std::uint8_t>((block * 2654435761u) >> 24));
  }
  const Scene scene = sceneOf(plate(1.0, std::make_shared<Texture>("squares", 512, 512, rgb)));
  for (const double roll : {0.0, 0.6}) {
    const Eigen::Vector3d from(-0.9, -0.8, 0.2), to(0.3, 0.2, 0.0);
    Eigen::Matrix3d R;
    R.col(2) = (to - from).normalized();
    R.col(0) = R.col(2).cross(Eigen::Vector3d::UnitZ()).normalized();
    R.col(1) = R.col(2).cross(R.col(0));
    const Pose X_WC{from, Eigen::Quaterniond(R) * Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitZ())};
    CameraConfig config = rgbConfig();
    const std::vector<double> seen = meansOf(renderOpenGl(CameraModel(config), X_WC, scene), 1);
    constexpr int kFiner = 4;
    config.width *= kFiner;
    config.height *= kFiner;
    config.quality = "high";
    const std::vector<double> means = meansOf(renderOpenGl(CameraModel(config), X_WC, scene), kFiner);
    double squares = 0.0;
    for (std::size_t k = 0; k < seen.size(); ++k) squares += (seen[k] - means[k]) * (seen[k] - means[k]);
    EXPECT_LT(std::sqrt(squares / double(seen.size())), kMost) << roll;
  }
}

TEST(OpenGlMaterial, PicturesOnMeshesAreLit) {
  Scene scene = sceneOf(plate(1.0, std::make_shared<Texture>("c", 1, 1, std::vector<std::uint8_t>{200, 100, 50})), 0.1);
  scene.lighting.lights[0].diffuse.setConstant(0.6);
  scene.lighting.lights[0].direction_W = {0.6, 0.0, -0.8};
  const Image image = renderOpenGl(CameraModel(rgbConfig()), kAbove, scene);
  for (int c = 0; c < 3; ++c)
    EXPECT_NEAR(image.pixel(160, 120)[c], (c == 0 ? 200 : c == 1 ? 100 : 50) * 0.58, kRounding);
}

TEST(OpenGlMaterial, BacksAreSeenOnlyOfTwoSidedThings) {
  Scene scene = sceneOf(plate(1.0, std::make_shared<Texture>("c", 1, 1, std::vector<std::uint8_t>(3, 255))), 0.1);
  scene.lighting.lights[0].diffuse.setConstant(0.5);
  scene.lighting.lights[0].direction_W = {0.0, 0.0, 1.0};  // at the back
  const Pose below{{0.0, 0.0, -1.0}, Eigen::Quaterniond::Identity()};
  const CameraModel camera(rgbConfig());
  EXPECT_EQ(renderOpenGl(camera, below, scene).pixel(160, 120)[0], 0);
  scene.bodies[0].shapes[0].material.two_sided = true;
  EXPECT_NEAR(renderOpenGl(camera, below, scene).pixel(160, 120)[0], 255 * 0.6, kRounding);
  EXPECT_NEAR(renderOpenGl(camera, kAbove, scene).pixel(160, 120)[0], 25.5, kRounding);
}

TEST(OpenGlMaterial, UnlitSurfacesHaveTheirOwnColourWhateverTheLightsAre) {
  Scene scene = sceneOf(plate(1.0, stripes(4)), 0.0);
  scene.bodies[0].shapes[0].material.unlit = true;
  scene.bodies[0].shapes[0].material.emissive.setConstant(0.5);
  const CameraModel camera(rgbConfig());
  const Image dark = renderOpenGl(camera, lookingDown({0.0, 0.0, 1.0}), scene);
  const auto [low, high] = spread(dark, 60, 260, 120);
  EXPECT_EQ(low, 0) << "nor does it glow";
  EXPECT_EQ(high, 255);
  scene.lighting.ambient.setConstant(0.7);
  scene.lighting.lights.push_back(lamp(Light::Type::kPoint, 3.0));
  EXPECT_EQ(renderOpenGl(camera, lookingDown({0.0, 0.0, 1.0}), scene).data, dark.data);
}

}  // namespace
}  // namespace aras_visual_servo_sim::testing::opengl_material_test
