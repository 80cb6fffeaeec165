// Lights, shadows, materials, fog and sky, against their formulas.
#include <gtest/gtest.h>

#include <cmath>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "aras_visual_servo_sim/scene/scene_loader.hpp"
#include "aras_visual_servo_sim/simulation/simulation_config.hpp"
#include "opengl_tools.hpp"

namespace aras_visual_servo_sim::testing {
namespace {

constexpr double kRounding = 1.0;  // grey levels: of the formula and of the picture

CameraConfig rgbConfig() {
  CameraConfig config = cameraConfig();
  config.encoding = "rgb8";
  return config;
}

/** A white floor at z = 0, and lights of its own. */
Scene floorUnder(const std::vector<Light>& lights) {
  Scene scene;
  scene.background = {0, 0, 0};
  scene.bodies.push_back(solid("floor", makeBox({4.0, 4.0, 0.02}), {255, 255, 255}, {0.0, 0.0, -0.01}));
  scene.bodies.back().casts_shadows = false;
  scene.lighting.ambient.setConstant(0.1);
  scene.lighting.lights = lights;
  return scene;
}

Light lamp(Light::Type type, double grey) {
  Light light;
  light.type = type;
  light.diffuse.setConstant(grey);
  return light;
}

const Pose kAbove = lookingDown({0.0, 0.0, 1.0});

/** Grey of the floor's point (x, y), seen from above. */
int greyAt(const Scene& scene, double x, double y, const Pose& X_WC = kAbove) {
  const CameraModel camera(rgbConfig());
  const Image image = renderOpenGl(camera, X_WC, scene);
  const Eigen::Vector2d px = *camera.project(X_WC.inverse() * Eigen::Vector3d(x, y, 0.0));
  return image.pixel(int(std::lround(px.x())), int(std::lround(px.y())))[0];
}

TEST(OpenGlLight, DirectionalLightFollowsLambert) {
  Light sun = lamp(Light::Type::kDirectional, 0.8);
  sun.direction_W = {-0.5, 0.5, -1.0};
  EXPECT_NEAR(greyAt(floorUnder({sun}), 0.2, 0.1), 255.0 * (0.1 + 0.8 / std::sqrt(1.5)), kRounding);
}

TEST(OpenGlLight, PointLightFallsOffWithDistanceAndEndsAtItsRange) {
  Light bulb = lamp(Light::Type::kPoint, 0.8);
  bulb.position_W = {0.1, 0.0, 0.5};
  bulb.constant = 1.0;
  bulb.linear_per_m = 0.5;
  bulb.quadratic_per_m2 = 2.0;
  bulb.range_m = 0.6;
  const CameraModel camera(rgbConfig());
  const Image image = renderOpenGl(camera, kAbove, floorUnder({bulb}));
  for (const int u : {100, 180, 220}) {
    const double x = (u - camera.cx()) / camera.fx(), y = (camera.cy() - 120) / camera.fy();
    const double d = Eigen::Vector3d(x - 0.1, y, 0.5).norm();
    const double expected = d < 0.6 ? 0.8 * (0.5 / d) / (1.0 + 0.5 * d + 2.0 * d * d) : 0.0;
    EXPECT_NEAR(image.pixel(u, 120)[0], 255.0 * (0.1 + expected), kRounding) << u;
  }
  EXPECT_NEAR(image.pixel(20, 120)[0], 25.5, kRounding);
}

TEST(OpenGlLight, SpotLightFadesBetweenItsAngles) {
  Light spot = lamp(Light::Type::kSpot, 0.8);
  spot.position_W = {0.0, 0.0, 1.0};
  spot.inner_angle_rad = 0.4;
  spot.outer_angle_rad = 0.8;
  spot.falloff = 2.0;
  spot.casts_shadows = false;
  const Scene scene = floorUnder({spot});
  const auto expected = [](double x) {
    const double cosine = 1.0 / std::hypot(1.0, x);
    const double part = (cosine - std::cos(0.4)) / (std::cos(0.2) - std::cos(0.4));
    return 255.0 * (0.1 + 0.8 * cosine * std::pow(std::clamp(part, 0.0, 1.0), 2.0));
  };
  const CameraModel camera(rgbConfig());
  const Image image = renderOpenGl(camera, kAbove, scene);
  for (const int u : {165, 190, 210, 225, 260}) {
    const double x = std::hypot((u - camera.cx()) / camera.fx(), (120 - camera.cy()) / camera.fy());
    EXPECT_NEAR(image.pixel(u, 120)[0], expected(x), kRounding) << u;
  }
}

TEST(OpenGlLight, HighlightIsBlinnsAndEmissionAddsUp) {
  Light sun = lamp(Light::Type::kDirectional, 0.3);
  sun.direction_W = {0.3, 0.0, -1.0};
  sun.specular.setConstant(0.5);
  Scene scene = floorUnder({sun});
  Material& material = scene.bodies[0].shapes[0].material;
  material.specular.setConstant(0.8);
  material.shininess = 30.0;
  material.emissive.setConstant(0.05);
  const CameraModel camera(rgbConfig());
  const Image image = renderOpenGl(camera, kAbove, scene);
  const Eigen::Vector3d toward = Eigen::Vector3d(-0.3, 0.0, 1.0).normalized();
  for (const int u : {100, 190, 240}) {
    const Eigen::Vector3d p((u - camera.cx()) / camera.fx(), (camera.cy() - 120) / camera.fy(), 0.0);
    const Eigen::Vector3d half = (toward + (Eigen::Vector3d(0.0, 0.0, 1.0) - p).normalized()).normalized();
    const double sum = 0.05 + 0.1 + 0.3 * toward.z() + 0.5 * 0.8 * std::pow(half.z(), 30.0);
    EXPECT_NEAR(image.pixel(u, 120)[0], 255.0 * sum, kRounding) << u;
  }
}

TEST(OpenGlLight, ShadowsLieWhereTheLightIsHidden) {
  for (const Light::Type type : {Light::Type::kDirectional, Light::Type::kSpot}) {
    Light light = lamp(type, 0.8);
    light.direction_W = {1.0, 0.0, -1.0};
    light.position_W = {-2.0, 0.0, 2.0};
    light.inner_angle_rad = 1.0;
    light.outer_angle_rad = 1.2;
    Scene scene = floorUnder({light});
    // Its shadow lies 0.3 to 0.4 m to the right of it.
    scene.bodies.push_back(solid("box", makeBox({0.1, 0.1, 0.1}), {255, 0, 0}, {-0.2, 0.0, 0.35}));
    const int shadow = greyAt(scene, 0.15, 0.0), lit = greyAt(scene, 0.5, 0.0);
    EXPECT_NEAR(shadow, 25.5, kRounding);
    EXPECT_GT(lit, 150);
    scene.lighting.shadows = false;
    EXPECT_GT(greyAt(scene, 0.15, 0.0), 150);
  }
}

TEST(OpenGlLight, ShadowEdgeIsSoftAndInItsPlace) {
  Light sun = lamp(Light::Type::kDirectional, 0.8);
  sun.direction_W = {1.0, 0.0, -1.0};
  Scene scene = floorUnder({sun});
  scene.lighting.shadow_map_px = 128;
  scene.bodies.push_back(solid("wall", makeBox({0.002, 1.0, 0.2}), {255, 0, 0}, {0.0, 0.0, 0.1}));
  const CameraModel camera(rgbConfig());
  const Image image = renderOpenGl(camera, kAbove, scene);
  // The wall is 0.2 m high: its shadow ends 0.2 m to its right. A texel is 1.0 m / 128 / cos(45 deg) there.
  const double texel_px = camera.fx() / 128.0 * std::sqrt(2.0);
  double sum = 0.0;
  for (int u = 180; u < 230; ++u) sum += (image.pixel(u, 120)[0] - 25.5) / (255.0 * 0.8 / std::sqrt(2.0));
  const double edge_px = 229.5 - sum, expected_px = camera.cx() + camera.fx() * 0.201;
  EXPECT_NEAR(edge_px, expected_px, 3.0 * texel_px + 1.0);
  bool soft = false;
  for (int u = 180; u < 230; ++u) soft = soft || (image.pixel(u, 120)[0] > 60 && image.pixel(u, 120)[0] < 140);
  EXPECT_TRUE(soft);
}

TEST(OpenGlLight, LitSidesOfSolidsDoNotShadeThemselves) {
  Scene scene = colourfulScene();
  const Pose X_WC = lookingDown({0.01, 0.02, 0.35}, 0.2, -0.3, 0.5);
  scene.bodies.erase(scene.bodies.begin());  // nothing to throw shadows on but themselves
  const CameraModel camera(rgbConfig());
  Scene alone = scene;
  for (Body& body : alone.bodies) body.visible = &body == &alone.bodies[2];
  const Image without = renderOpenGl(camera, X_WC, alone);
  alone.lighting.shadows = true;
  const Difference difference = differenceOf(without, renderOpenGl(camera, X_WC, alone));
  EXPECT_LE(difference.inside, 6);  // of a ball: only where light grazes it
}

TEST(OpenGlLight, ShadowMapsAreDrawnAnewOnlyWhenSomethingMoved) {
  Scene scene = colourfulScene();
  scene.lighting.shadows = true;
  const CameraModel camera(rgbConfig());
  OpenGlRenderer renderer;
  Image image;
  const auto drawnAfter = [&](double camera_z) {
    renderer.render(camera, lookingDown({0.0, 0.0, camera_z}), scene, image);
    return renderer.statistics().shadow_maps;
  };
  EXPECT_EQ(drawnAfter(0.5), 1);
  EXPECT_EQ(drawnAfter(0.6), 1);
  scene.bodies[3].X_WB.p.x() += 0.01;
  EXPECT_EQ(drawnAfter(0.6), 2);
  scene.light_direction_W.x() += 0.1;
  EXPECT_EQ(drawnAfter(0.6), 3);
  const Image after = image;
  EXPECT_EQ(renderOpenGl(camera, lookingDown({0.0, 0.0, 0.6}), scene).data, after.data);
}

TEST(OpenGlLight, TransparentThingsLetTheirShareThrough) {
  Scene scene = floorUnder({});
  scene.lighting.lights = {lamp(Light::Type::kDirectional, 0.0)};
  scene.lighting.ambient.setConstant(1.0);
  scene.bodies.push_back(solid("glass", makeBox({0.2, 0.2, 0.1}), {0, 0, 255}, {0.0, 0.0, 0.2}));
  scene.bodies.back().shapes[0].material.opacity = 0.25;
  const CameraModel camera(rgbConfig());
  const Image image = renderOpenGl(camera, kAbove, scene);
  EXPECT_NEAR(image.pixel(160, 120)[0], 0.75 * 255.0, kRounding);
  EXPECT_NEAR(image.pixel(160, 120)[2], 255.0, kRounding);
}

TEST(OpenGlLight, FogHidesWhatIsFarAndSkyTurnsFromHorizonToZenith) {
  Scene scene = floorUnder({lamp(Light::Type::kDirectional, 0.0)});
  scene.lighting.ambient.setConstant(1.0);
  scene.lighting.fog = Fog{{100, 100, 100}, 0.8};
  const double left = std::exp(-0.8 * 0.8);
  EXPECT_NEAR(greyAt(scene, 0.0, 0.0), 255.0 * left + 100.0 * (1.0 - left), kRounding);
  scene.background = {200, 200, 200};
  scene.lighting.zenith = Rgb{20, 20, 20};
  const Pose up{{0.0, 0.0, 1.0}, Eigen::Quaterniond::Identity()};
  const Image image = renderOpenGl(CameraModel(rgbConfig()), up, scene);
  EXPECT_NEAR(image.pixel(160, 120)[0], 20, kRounding);
  EXPECT_GT(image.pixel(5, 5)[0], 25);
}

// --- Gazebo ---------------------------------------------------------------------------------------------------------

/** A Gazebo world with its sun; models as its materials have them. */
Scene gazeboScene() {
  const YAML::Node node = YAML::Load(R"(
compatibility: gazebo
scene:
  solids:
  - name: ground
    box_m: [4, 4, 0.02]
    position_m: [0, 0, -0.01]
    color_rgb: [178.5, 178.5, 178.5]
    material: {ambient_share: 0.428571, specular_rgb: [2.55, 2.55, 2.55], shininess: 1.5, casts_shadows: false}
  - {name: white, box_m: [0.2, 0.2, 0.2], position_m: [0, 0, 0.1], color_rgb: [255, 255, 255]}
  - name: black
    box_m: [0.2, 0.2, 0.2]
    position_m: [0.6, 0, 0.1]
    color_rgb: [0, 0, 0]
    material: {specular_rgb: [25.5, 25.5, 25.5], shininess: 5}
)");
  return loadScene(SimulationConfig::fromYaml(node).scene, PackagePaths());
}

/** Red of what a camera at p_W sees that looks at a point, in the middle of its image. */
int greySeen(const Scene& scene, const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  const Eigen::Quaterniond q = Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), to - from);
  return renderOpenGl(CameraModel(rgbConfig()), {from, q}, scene).pixel(160, 120)[0];
}

TEST(OpenGlGazebo, GreysAreThoseOfGazebo) {
  constexpr double kLevels = 2.0;
  const Scene scene = gazeboScene();
  EXPECT_NEAR(greySeen(scene, {0.3, -1.0, 1.0}, {0.3, -0.6, 0.0}), 147, kLevels) << "ground";
  EXPECT_NEAR(greySeen(scene, {-0.2, 1.0, 1.0}, {-0.05, 0.15, 0.0}), 31, kLevels) << "ground in shadow";
  EXPECT_NEAR(greySeen(scene, {0.0, 0.0, 1.0}, {0.0, 0.0, 5.0}), 178, kLevels) << "sky";
  EXPECT_NEAR(greySeen(scene, {0.1, 0.0, 1.0}, {0.0, 0.0, 0.2}), 255, kLevels) << "white, upward";
  EXPECT_NEAR(greySeen(scene, {0.35, 0.0, 0.2}, {0.1, 0.0, 0.15}), 185, kLevels) << "white, side to the sun";
  EXPECT_NEAR(greySeen(scene, {-0.9, 0.0, 0.2}, {-0.1, 0.0, 0.1}), 102, kLevels) << "white, away from the sun";
  EXPECT_LE(greySeen(scene, {0.7, 0.0, 1.0}, {0.6, 0.0, 0.2}), 3) << "black";
}

TEST(OpenGlGazebo, LightsOfTheSectionStayAsTheyAre) {
  const YAML::Node node = YAML::Load(
      "{compatibility: gazebo, scene: {background_rgb: [1, 2, 3], lighting: {lights: [{name: a, type: point}]}}}");
  const Scene scene = loadScene(SimulationConfig::fromYaml(node).scene, PackagePaths());
  EXPECT_EQ(scene.background.g, 2);
  ASSERT_EQ(scene.lighting.lights.size(), 1u);
  EXPECT_EQ(scene.lighting.lights[0].name, "a");
}

}  // namespace
}  // namespace aras_visual_servo_sim::testing
