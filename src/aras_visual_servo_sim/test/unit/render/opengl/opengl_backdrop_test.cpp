// A floor or a wall behind everything, and the sky, are drawn with one sample a pixel where nothing else is: the image
// is the one that several samples all over give, up to the rounding of a value between two grey levels.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <random>

#include "light_tools.hpp"
#include "render/opengl/scene/backdrop.hpp"

namespace aras_visual_servo_sim::testing::opengl_backdrop_test {
namespace {

/** A mark in the upper left corner of the image, with which all of it is drawn with several samples. */
Scene withMark(Scene scene, const CameraModel& camera, const Pose& X_WC) {
  const double z = 2.0 * camera.nearM(), side = 2.0 * z / camera.fx();
  const Eigen::Vector3d p_C((0.0 - camera.cx()) / camera.fx() * z, (0.0 - camera.cy()) / camera.fy() * z, z);
  scene.models.emplace_back("mark", std::vector<Polygon>{{{-side, -side}, {side, -side}, {side, side}, {-side, side}}},
                            Rgb{1, 2, 3});
  scene.models.back().X_WM = {X_WC * p_C, X_WC.q};
  return scene;
}

/** What a comparison of all images of a scene found. */
struct Found {
  double different = 0.0;  ///< share of the values that are not the same
  int apart = 0;           ///< by how much, at most
  double sampled = 0.0;    ///< share of the pixels that had several samples
  double least = 1.0;      ///< the same of the image that had fewest
};

/** Rounding: of one level, here and there. */
void expectTheSame(const Found& found, const char* what, double most = 1e-5) {
  EXPECT_LE(found.apart, 1) << what;
  EXPECT_LE(found.different, most) << what;
}

CameraConfig plainTargets() {
  CameraConfig config = rgbConfig();
  config.exact_targets = false;
  return config;
}

/** From many places about the origin, most of them looking down, some at the horizon. */
Found compare(const Scene& scene, const CameraConfig& config = plainTargets(), int count = 40) {
  constexpr int kCorner = 8;  // [px] about the mark
  const CameraModel camera(config);
  std::mt19937 generator(7);
  std::uniform_real_distribution<double> share(-1.0, 1.0);
  Found found;
  for (int n = 0; n < count; ++n) {
    // One after the other: compilers evaluate arguments in different orders.
    const double roll = 3.0 * share(generator), tilt_y = 0.5 * share(generator), tilt_x = 1.6 * share(generator);
    const Pose X_WC = lookingDown({0.5 * share(generator), 0.5 * share(generator), 0.8 + 0.5 * share(generator)},
                                  tilt_x, tilt_y, roll);
    const Image in_parts = renderOpenGl(camera, X_WC, scene);
    const double sampled = double(sharedOpenGl().statistics().sampled_px) / (camera.width() * camera.height());
    const Image whole = renderOpenGl(camera, X_WC, withMark(scene, camera, X_WC));
    EXPECT_EQ(sharedOpenGl().statistics().sampled_px, camera.width() * camera.height());
    for (int v = 0; v < camera.height(); ++v) {
      for (int u = v < kCorner ? kCorner : 0; u < camera.width(); ++u) {
        for (int c = 0; c < 3; ++c) {
          const int apart = std::abs(int(in_parts.pixel(u, v)[c]) - int(whole.pixel(u, v)[c]));
          found.different += apart > 0 ? 1.0 / (3.0 * count * camera.width() * camera.height()) : 0.0;
          found.apart = std::max(found.apart, apart);
        }
      }
    }
    found.sampled += sampled / count;
    found.least = std::min(found.least, sampled);
  }
  return found;
}

Light sun() {
  Light light = lamp(Light::Type::kDirectional, 0.7);
  light.direction_W = {0.4, 0.3, -1.0};
  return light;
}

Scene floorAlone() {
  Scene scene = floorUnder({sun()});
  scene.background = {90, 120, 160};
  return scene;
}

void addThings(Scene& scene) {
  scene.bodies.push_back(solid("box", makeBox({0.1, 0.02, 0.06}), {255, 0, 0}, {0.1, -0.05, 0.12}, {0.3, 0.2, 1}));
  scene.bodies.push_back(solid("ball", makeSphere(0.06), {0, 200, 60}, {-0.3, 0.2, 0.1}));
}

TEST(OpenGlBackdrop, AFloorAlone) {
  const Found found = compare(floorAlone());
  expectTheSame(found, "floor");
  EXPECT_EQ(found.least, 0.0);
  EXPECT_LT(found.sampled, 0.3);
}

TEST(OpenGlBackdrop, ThingsOnAFloorWithTheirShadows) {
  Scene scene = floorAlone();
  addThings(scene);
  const Found found = compare(scene);
  expectTheSame(found, "things");
  EXPECT_LT(found.sampled, 0.6);
  EXPECT_LT(found.least, 0.1);
}

TEST(OpenGlBackdrop, AllThatAFloorMayLookLike) {
  const std::pair<const char*, std::function<void(Scene&)>> kinds[] = {
      {"sky",
       [](Scene& s) {
         s.lighting.zenith = Rgb{20, 60, 200};
       }},
      {"fog",
       [](Scene& s) {
         s.lighting.fog = Fog{{200, 200, 210}, 0.3};
       }},
      {"highlight",
       [](Scene& s) {
         s.bodies[0].shapes[0].material.specular.setConstant(0.5);
         s.bodies[0].shapes[0].material.shininess = 20.0;
         s.lighting.lights[0].specular.setConstant(1.0);
       }},
      {"two-sided", [](Scene& s) { s.bodies[0].shapes[0].material.two_sided = true; }},
      {"point light",
       [](Scene& s) {
         Light light = lamp(Light::Type::kPoint, 1.0);
         light.position_W = {0.3, 0.0, 0.5};
         s.lighting.lights.push_back(light);
       }},
      {"glass before it",
       [](Scene& s) {
         s.bodies.push_back(solid("glass", makeBox({0.3, 0.2, 0.01}), {0, 0, 255}, {0.0, 0.2, 0.3}));
         s.bodies.back().shapes[0].material.opacity = 0.4;
       }},
      {"a wall, partly in the floor",
       [](Scene& s) {
         s.bodies.push_back(solid("wall", makeBox({0.05, 3.0, 2.0}), {250, 240, 200}, {1.0, 0, 0.3}));
       }},
      {"slanted",
       [](Scene& s) {
         s.bodies[0].X_WB.q = quaternionFromRpy({0.2, -0.3, 0.1});
       }},
  };
  for (const auto& [name, change] : kinds) {
    Scene scene = floorAlone();
    change(scene);
    addThings(scene);
    const Found found = compare(scene, plainTargets(), 15);
    expectTheSame(found, name);
    EXPECT_LT(found.least, 0.5) << name;
  }
}

TEST(OpenGlBackdrop, APictureOnABoard) {
  auto mesh = std::make_shared<TriangleMesh>(*makeBox({3.0, 3.0, 0.02}));
  std::vector<std::uint8_t> rgb;
  for (int k = 0; k < 64 * 64; ++k) {
    const auto grey = static_cast<std::uint8_t>((k / 4 + k / 256) % 2 ? 250 : 40);
    rgb.insert(rgb.end(), {grey, static_cast<std::uint8_t>(k % 251), grey});
  }
  mesh->texture_coordinates.resize(mesh->points.size());
  for (std::size_t k = 0; k < mesh->points.size(); ++k) {
    mesh->texture_coordinates[k] = {0.5f + mesh->points[k].x() / 3.0f, 0.5f - mesh->points[k].y() / 3.0f};
  }
  mesh->pictures = {{std::make_shared<Texture>("squares", 64, 64, rgb)}};
  mesh->picture_of.assign(mesh->triangles.size(), 0);
  Scene scene = floorAlone();
  scene.bodies[0].shapes[0].mesh = mesh;
  addThings(scene);
  const Found found = compare(scene);
  expectTheSame(found, "picture", 1e-3);  // between texels as well
  EXPECT_LT(found.least, 0.2);
}

TEST(OpenGlBackdrop, CutByTheNearAndByTheFarPlane) {
  for (const auto& [near_m, far_m] : {std::pair(0.5, 100.0), std::pair(0.01, 0.9)}) {
    CameraConfig config = plainTargets();
    config.near_m = near_m;
    config.far_m = far_m;
    Scene scene = floorAlone();
    const Found found = compare(scene, config);
    expectTheSame(found, near_m > 0.1 ? "near" : "far");
    EXPECT_GT(found.sampled, 0.02);
  }
}

TEST(OpenGlBackdrop, AHighlightThatNoLevelShowsIsLeftOut) {
  CameraConfig fine = rgbConfig();
  fine.encoding = "rgb16";
  for (const CameraConfig& config : {rgbConfig(), fine}) {
    const CameraModel camera(config);
    const auto greyOf = [&](double specular) {
      Scene scene = floorUnder({lamp(Light::Type::kDirectional, 0.5012)});
      scene.lighting.lights[0].specular.setConstant(0.1);
      scene.lighting.lights[0].direction_W = {0, 0, -1};
      scene.bodies[0].shapes[0].material.specular.setConstant(specular);
      scene.bodies[0].shapes[0].material.shininess = 1.5;
      if (config.encoding == "rgb16") {
        FineImage image;
        sharedOpenGl().render(camera, kAbove, scene, image);
        return double(image.pixel(160, 120)[0]) / 257.0;
      }
      return double(renderOpenGl(camera, kAbove, scene).pixel(160, 120)[0]);
    };
    const double none = greyOf(0.0);
    EXPECT_NEAR(greyOf(0.4) - none, 10.2, kRounding);
    EXPECT_NEAR(greyOf(0.01) - none, config.encoding == "rgb16" ? 0.255 : 0.0, 0.01);
    EXPECT_NEAR(greyOf(0.04) - none, 1.0, 0.6);
  }
}

TEST(OpenGlBackdrop, MaterialsThatDifferInTheirExponentAreNotMixedUp) {
  // Seen at 45 deg from the reflection: the highlight is its exponent's power of cos 22.5 deg.
  OpenGlRenderer renderer;  // that has no shader yet
  const Pose X_WC{{0.6, 0.0, 0.6},
                  Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), Eigen::Vector3d(-1, 0, -1))};
  const auto greyOf = [&](const Scene& scene) {
    Image image;
    renderer.render(CameraModel(rgbConfig()), X_WC, scene, image);
    return int(image.pixel(160, 120)[0]);
  };
  for (const double exponent : {1.0, 1.5, 20.0, 1.0, 1.5}) {
    Scene scene = floorUnder({lamp(Light::Type::kDirectional, 0.2)});
    scene.lighting.lights[0].specular.setConstant(1.0);
    scene.lighting.lights[0].direction_W = {0, 0, -1};
    Material& material = scene.bodies[0].shapes[0].material;
    const int matt = greyOf(scene);
    material.specular.setConstant(0.5);
    material.shininess = exponent;
    const int grey = greyOf(scene);
    EXPECT_NEAR(grey - matt, 127.5 * std::pow(std::cos(M_PI / 8.0), exponent), 1.5 * kRounding) << exponent;
  }
}

TEST(OpenGlBackdrop, AMeshOfManyTrianglesIsDrawnOnce) {
  PixelParts parts({0, 0, 320, 240});
  parts.add({0, 0, 60, 60});
  parts.add({200, 0, 260, 60});
  parts.add({100, 180, 160, 240});
  parts.join({50, 50, 201, 70}, 8000.0);  // joined they have 8400 pixels more
  ASSERT_EQ(parts.parts().size(), 3u);
  parts.join({50, 50, 201, 70}, 9000.0);
  ASSERT_EQ(parts.parts().size(), 2u);
  EXPECT_EQ(parts.parts()[1].u1, 260);
  EXPECT_EQ(parts.parts()[1].v1, 60);
  EXPECT_EQ(parts.parts()[0].v0, 180);
}

TEST(OpenGlBackdrop, OnlyWhatHasNoEdgesWithinItsOutline) {
  EXPECT_TRUE(canBeBackdrop(*makeBox({1.0, 2.0, 0.1})));
  EXPECT_FALSE(canBeBackdrop(*makeSphere(1.0)));
  TriangleMesh crossed = *makeBox({1.0, 1.0, 1.0});  // two boxes through each other
  const std::size_t count = crossed.points.size();
  for (std::size_t k = 0; k < count; ++k) {
    crossed.points.emplace_back(crossed.points[k] + Eigen::Vector3f(0.5f, 0.2f, 0.3f));
    crossed.normals.push_back(crossed.normals[k]);
  }
  const auto triangles = crossed.triangles;
  for (const auto& t : triangles) {
    const auto shift = static_cast<std::uint32_t>(count);
    crossed.triangles.push_back({t[0] + shift, t[1] + shift, t[2] + shift});
  }
  crossed.finish();
  EXPECT_EQ(crossed.triangles.size(), 24u);
  EXPECT_FALSE(canBeBackdrop(crossed));
}

}  // namespace
}  // namespace aras_visual_servo_sim::testing::opengl_backdrop_test
