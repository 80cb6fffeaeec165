// Pictures of normals on meshes, against Lambert's law for the normal that they give.
#include <gtest/gtest.h>
#include <stb/stb_image_write.h>

#include <cmath>
#include <fstream>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "aras_visual_servo_sim/scene/mesh_loader.hpp"
#include "light_tools.hpp"
#include "tools/folder_fixture.hpp"
#include "tools/messages.hpp"

namespace aras_visual_servo_sim::testing::opengl_bumps_test {
namespace {

constexpr double kSun = 0.7, kAmbient = 0.1;

class OpenGlBumps : public FolderFixture {
 protected:
  void writePicture(const std::string& name, const Rgb& color) const {
    std::vector<std::uint8_t> rgb;
    for (int k = 0; k < 16; ++k) rgb.insert(rgb.end(), {color.r, color.g, color.b});
    stbi_write_png(path(name).c_str(), 4, 4, 3, rgb.data(), 12);
  }
  /** A white square of 4 m in z = 0, the picture's s along x and its top at +y; mirrored: its s against x. */
  MeshPtr plate(const std::string& keys, bool mirrored = false) const {
    std::ofstream(path("plate.mtl")) << "newmtl m\nKd 1 1 1\n" << keys << "\n";
    const std::string left = mirrored ? "1" : "0", right = mirrored ? "0" : "1";
    std::ofstream(path("plate.obj")) << "mtllib plate.mtl\nv -2 -2 0\nv 2 -2 0\nv 2 2 0\nv -2 2 0\nvt " << left
                                     << " 0\nvt " << right << " 0\nvt " << right << " 1\nvt " << left
                                     << " 1\nvn 0 0 1\nusemtl m\nf 1/1/1 2/2/1 3/3/1\nf 1/1/1 3/3/1 4/4/1\n";
    return loadMesh(path("plate.obj"), Eigen::Vector3d::Ones(), PackagePaths());
  }
};

/** The normal that a texel stands for. */
Eigen::Vector3d normalOf(const Rgb& texel) {
  return (Eigen::Vector3d(texel.r, texel.g, texel.b) / 127.5 - Eigen::Vector3d::Ones()).normalized();
}

Scene sceneOf(const MeshPtr& mesh, const Eigen::Vector3d& sun, const Pose& X_WB = Pose()) {
  Scene scene;
  scene.background = {0, 0, 0};
  scene.lighting.ambient.setConstant(kAmbient);
  scene.lighting.lights = {lamp(Light::Type::kDirectional, kSun)};
  scene.lighting.lights[0].direction_W = sun;
  scene.lighting.shadows = false;
  scene.bodies.push_back(solid("plate", mesh, {255, 255, 255}, {0.0, 0.0, 0.0}));
  scene.bodies[0].X_WB = X_WB;
  return scene;
}

double litGrey(const Eigen::Vector3d& n_W, const Eigen::Vector3d& sun) {
  return 255.0 * (kAmbient + kSun * std::max(0.0, -n_W.dot(sun.normalized())));
}

TEST_F(OpenGlBumps, SurfacesAreLitByTheNormalOfTheirPictureFromEverywhere) {
  const Eigen::Vector3d sun(-0.5, 0.3, -1.0);
  const CameraModel camera(rgbConfig());
  for (const Rgb& texel : {Rgb{200, 128, 220}, Rgb{128, 60, 220}, Rgb{70, 190, 200}, Rgb{128, 128, 255}}) {
    writePicture("n.png", texel);
    for (const bool mirrored : {false, true}) {
      const MeshPtr mesh = plate("norm n.png", mirrored);
      ASSERT_TRUE(mesh->pictures.at(0).normals);
      Eigen::Vector3d n = normalOf(texel);
      if (mirrored) n.x() = -n.x();
      for (const double turn : {0.0, 0.9}) {
        const Pose X_WB{{0.0, 0.0, 0.0}, quaternionFromRpy({0.1, -0.2, turn})};
        for (const Pose& X_WC : {kAbove, lookingDown({0.1, 0.2, 0.8}, 0.4, -0.3, 1.2)}) {
          const Image image = renderOpenGl(camera, X_WC, sceneOf(mesh, sun, X_WB));
          for (const int u : {40, 160, 280}) {
            EXPECT_NEAR(image.pixel(u, 120)[0], litGrey(X_WB.q * n, sun), kRounding)
                << int(texel.r) << ' ' << mirrored << ' ' << turn << ' ' << u;
          }
        }
      }
    }
  }
}

TEST_F(OpenGlBumps, TheyAddToTheColourAndToItsPicture) {
  const Eigen::Vector3d sun(-0.6, 0.0, -0.8);
  const Rgb texel{220, 128, 200};
  writePicture("n.png", texel);
  writePicture("c.png", {100, 200, 50});
  const Image image = renderOpenGl(CameraModel(rgbConfig()), kAbove, sceneOf(plate("map_Kd c.png\nnorm n.png"), sun));
  const double lit = litGrey(normalOf(texel), sun) / 255.0;
  EXPECT_NEAR(image.pixel(160, 120)[0], 100 * lit, kRounding);
  EXPECT_NEAR(image.pixel(160, 120)[1], 200 * lit, kRounding);
  EXPECT_NEAR(image.pixel(160, 120)[2], 50 * lit, kRounding);
}

TEST_F(OpenGlBumps, HighlightsFollowThem) {
  const Rgb texel{220, 128, 200};
  writePicture("n.png", texel);
  const Eigen::Vector3d n = normalOf(texel);
  // Seen from straight above in the middle: the light that this normal mirrors to the camera.
  const Eigen::Vector3d mirror = 2.0 * n.z() * n - Eigen::Vector3d::UnitZ();
  Scene scene = sceneOf(plate("norm n.png"), -mirror);
  scene.lighting.lights[0].diffuse.setZero();
  scene.lighting.lights[0].specular.setConstant(0.8);
  scene.bodies[0].shapes[0].material.specular.setConstant(0.5);
  scene.bodies[0].shapes[0].material.shininess = 200.0;
  const CameraModel camera(rgbConfig());
  EXPECT_NEAR(renderOpenGl(camera, kAbove, scene).pixel(160, 120)[0], 255 * (kAmbient + 0.4), kRounding + 1);
  scene.bodies[0].shapes[0].mesh = plate("");
  EXPECT_NEAR(renderOpenGl(camera, kAbove, scene).pixel(160, 120)[0], 255 * kAmbient, kRounding);
}

TEST_F(OpenGlBumps, OfBumpsThoseThatAreBluishAreNormalsAndGreyOnesAreNot) {
  writePicture("n.png", {150, 120, 240});
  writePicture("heights.png", {90, 90, 90});
  EXPECT_TRUE(plate("map_Bump n.png")->pictures.at(0).normals);
  EXPECT_TRUE(plate("map_Bump heights.png")->pictures.empty());
}

TEST_F(OpenGlBumps, APictureThatIsNotThereIsNamed) {
  const std::string said = messageOf<ModelError>([this] { plate("norm nowhere.png"); });
  EXPECT_HAS(said, "nowhere.png");
  EXPECT_HAS(said, "plate.obj");
}

}  // namespace
}  // namespace aras_visual_servo_sim::testing::opengl_bumps_test
