// Lights, shadows, materials, fog and sky, against their formulas.
#include <gtest/gtest.h>

#include <cmath>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "aras_visual_servo_sim/robot/urdf_loader.hpp"
#include "aras_visual_servo_sim/scene/scene_loader.hpp"
#include "aras_visual_servo_sim/simulation/simulation.hpp"
#include "aras_visual_servo_sim/simulation/simulation_config.hpp"
#include "light_tools.hpp"

namespace aras_visual_servo_sim::testing::opengl_light_test {
namespace {

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

/** A robot of fixed boxes with Gazebo's materials and one without any, the first over a ground: loaded as a simulation.
 */
const char* const kPaintedRobot = R"(<robot name="r"><link name="world"/>
  <link name="grey"><visual><geometry><box size="4 4 0.02"/></geometry></visual></link>
  <link name="plain"><visual><geometry><box size="0.2 0.2 0.2"/></geometry></visual></link>
  <link name="black"><visual><geometry><box size="0.2 0.2 0.2"/></geometry></visual></link>
  <link name="roof"><visual><geometry><box size="0.3 0.3 0.02"/></geometry></visual></link>
  <joint name="a" type="fixed"><parent link="world"/><child link="grey"/><origin xyz="0 0 -0.01"/></joint>
  <joint name="b" type="fixed"><parent link="world"/><child link="plain"/><origin xyz="0 0 0.1"/></joint>
  <joint name="c" type="fixed"><parent link="world"/><child link="black"/><origin xyz="0.6 0 0.1"/></joint>
  <joint name="d" type="fixed"><parent link="world"/><child link="roof"/><origin xyz="0.5 -0.5 1.2"/></joint>
  <gazebo reference="grey"><material>Gazebo/Grey</material></gazebo>
  <gazebo reference="black"><material>Gazebo/Black</material></gazebo>
</robot>)";

TEST(OpenGlGazebo, MaterialsOfARobotHaveGazebosGreys) {
  constexpr double kLevels = 2.0;
  const auto greySeenBy = [](const std::string& urdf, const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
    const YAML::Node node = YAML::Load("{compatibility: gazebo}");
    Simulation sim(loadRobotModel(urdf, "test"), SimulationConfig::fromYaml(node), YAML::Node());
    Scene scene = sim.scene();
    for (Body& body : scene.bodies) {
      body.X_WB = sim.body().linkPose(body.name);
      body.casts_shadows = body.name != "grey";
    }
    return greySeen(scene, from, to);
  };
  EXPECT_NEAR(greySeenBy(kPaintedRobot, {0.3, -1.0, 1.0}, {0.3, -0.6, 0.0}), 147, kLevels) << "Grey, upward";
  EXPECT_NEAR(greySeenBy(kPaintedRobot, {-0.2, 1.0, 1.0}, {-0.05, 0.15, 0.0}), 31, kLevels) << "Grey in shadow";
  // The roof throws its shadow on the plain box's top, 1 m under it, 0.5 m to its side.
  EXPECT_NEAR(greySeenBy(kPaintedRobot, {-0.4, 0.4, 0.6}, {0.0, 0.0, 0.2}), 102, kLevels) << "plain, in shadow";
  std::string open = kPaintedRobot;
  open.replace(open.find("0.5 -0.5 1.2"), 12, "9.5 -0.5 1.2");
  EXPECT_NEAR(greySeenBy(open, {-0.4, 0.4, 0.6}, {0.0, 0.0, 0.2}), 255, kLevels) << "plain, upward";
  EXPECT_NEAR(greySeenBy(open, {0.35, 0.0, 0.15}, {0.1, 0.0, 0.1}), 185, kLevels) << "plain, to the sun";
  EXPECT_LE(greySeenBy(kPaintedRobot, {0.7, 0.0, 1.0}, {0.6, 0.0, 0.2}), 3) << "Black";
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
}  // namespace aras_visual_servo_sim::testing::opengl_light_test
