// Lights of a simulation: they come and go, links and models carry them, saved states and resets have them.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "aras_visual_servo_sim/robot/urdf_loader.hpp"
#include "aras_visual_servo_sim/scene/light_entry.hpp"
#include "tools/pan_lift.hpp"

namespace aras_visual_servo_sim::light_test {
namespace {

/** A camera above a white floor that one weak sun lights from above. */
std::string lit(const std::string& camera = "", const std::string& lights = "") {
  return "{cameras: [{name: camera, frame: eye_optical_frame, width: 40, height: 30, horizontal_fov_rad: 1.0, "
         "encoding: mono8, renderer: opengl" +
         camera +
         "}], scene: {background_rgb: [0, 0, 0], lighting: {ambient_rgb: [0, 0, 0], lights: [{name: sun, type: "
         "directional, direction: [0, 0, -1], color_rgb: [51, 51, 51]}" +
         lights +
         "]}, models: [{name: target, outlines_m: [[[2, 2], [2.1, 2], [2, 2.1]]]}], "
         "solids: [{name: floor, box_m: [4, 4, 0.02], position_m: [0, 0, -0.01], color_rgb: [255, 255, 255]}]}}";
}

int middle(Simulation& simulation) { return *simulation.render(0).pixel(20, 15); }

Light lamp(const std::string& more) { return lightFromYaml(YAML::Load("{name: lamp, type: point, " + more + "}")); }

TEST(Lights, ComeChangeAndGo) {
  Simulation simulation = fixture::panLift(lit());
  EXPECT_NEAR(middle(simulation), 51, 1);
  Light light =
      lightFromYaml(YAML::Load("{name: second, type: directional, direction: [0, 0, -1], color_rgb: [100, "
                               "100, 100]}"));
  simulation.setLight(light);
  ASSERT_EQ(simulation.lights().size(), 2u);
  EXPECT_NEAR(middle(simulation), 151, 1);
  light.diffuse.setConstant(50.0 / 255.0);
  simulation.setLight(light);
  ASSERT_EQ(simulation.lights().size(), 2u);
  EXPECT_NEAR(middle(simulation), 101, 1);
  simulation.deleteLight("sun");
  EXPECT_NEAR(middle(simulation), 50, 1);
  simulation.deleteLight("second");
  EXPECT_EQ(middle(simulation), 0);  // dark: the coverage renderer's lights do not come back
  simulation.reset();
  EXPECT_NEAR(middle(simulation), 51, 1);
}

TEST(Lights, OfALinkMoveWithIt) {
  // Half a metre above the floor at first; a fifth higher with the lift.
  Simulation simulation = fixture::panLift(
      lit("",
          ", {name: lamp, type: point, attached_to: head, position_m: [0, 0, 0.1], attenuation_constant: 1.0e-9, "
          "attenuation_quadratic: 1.0, color_rgb: [51, 51, 51]}"));
  const auto expected = [](double height_m) { return 51.0 + 51.0 / (height_m * height_m); };
  EXPECT_NEAR(middle(simulation), expected(0.6), 1);
  simulation.setJointPositions({{"lift", 0.2}});
  EXPECT_NEAR(middle(simulation), expected(0.8), 1);
  EXPECT_TRUE(simulation.lights()[1].position_W.isApprox(Eigen::Vector3d(0, 0, 0.8), 1e-9));
}

TEST(Lights, OfAModelMoveAndGoWithIt) {
  Simulation simulation = fixture::panLift(lit());
  const std::string ball =
      "{name: ball, urdf: \"<robot name='b'><link name='l'><visual><geometry><sphere "
      "radius='0.01'/></geometry></visual>"
      "</link><gazebo reference='l'><light name='glow' type='point'><pose>0 0 0.2 0 0 0</pose><diffuse>0.2 0.2 0.2 1"
      "</diffuse><attenuation><constant>1</constant><linear>0</linear></attenuation></light></gazebo></robot>\", "
      "position_m: [1.0, 0, 0.3]}";
  simulation.spawnModel(YAML::Load(ball));
  ASSERT_EQ(simulation.lights().size(), 2u);
  EXPECT_EQ(simulation.lights()[1].name, "ball::glow");
  EXPECT_NEAR(middle(simulation), 51.0 + 51.0 * 0.5 / std::hypot(0.5, 1.0), 1);
  simulation.setModelPose("ball", Pose{{0.5, 0.0, 0.3}, Eigen::Quaterniond::Identity()});
  EXPECT_NEAR(middle(simulation), 51.0 + 51.0 * 0.5 / std::hypot(0.5, 0.5), 1);
  simulation.deleteModel("ball");
  EXPECT_EQ(simulation.lights().size(), 1u);
  EXPECT_NEAR(middle(simulation), 51, 1);
}

TEST(Lights, OfAUrdfsGazeboTagsLightTheScene) {
  const std::string urdf =
      "<robot name='r'><link name='base'/><gazebo reference='base'><light name='torch' type='spot'><pose>0 0 0.5 0 0 0"
      "</pose><attenuation><constant>1</constant><linear>0</linear></attenuation><spot><inner_angle>0.4</inner_angle>"
      "<outer_angle>0.6</outer_angle><falloff>1</falloff></spot></light></gazebo></robot>";
  const RobotModel model = loadRobotModel(urdf, "test");
  EXPECT_TRUE(model.warnings.empty());
  Simulation simulation(model, SimulationConfig{}, {});
  ASSERT_EQ(simulation.lights().size(), 1u);
  EXPECT_EQ(simulation.lights()[0].attached_to, "base");
  EXPECT_TRUE(simulation.scene().lighting.as_coverage.value_or(true));  // the torch adds to the light there is
  const std::string wrong = std::string(urdf).replace(urdf.find("type='spot'"), 11, "type='beam'");
  try {
    Simulation(loadRobotModel(wrong, "test"), SimulationConfig{}, {});
    ADD_FAILURE() << "accepted";
  } catch (const ArasError& error) {
    EXPECT_NE(std::string(error.what()).find("beam"), std::string::npos) << error.what();
  }
}

TEST(Lights, AreInTheSavedStateAndInTheRunHash) {
  Simulation simulation = fixture::panLift(lit()), other = fixture::panLift(lit());
  const std::string dark = fixture::hashOf(other, 3);
  other.reset();
  simulation.setLight(lamp("attached_to: head, color_rgb: [99, 9, 9]"));
  simulation.deleteLight("sun");
  const std::string state = simulation.saveState();
  const std::string hash = fixture::hashOf(simulation, 3);
  EXPECT_NE(hash, dark);
  simulation.reset();
  EXPECT_EQ(fixture::hashOf(simulation, 3), dark);
  for (Simulation* each : {&simulation, &other}) {
    each->restoreState(state);
    ASSERT_EQ(each->lights().size(), 1u);
    EXPECT_EQ(each->lights()[0].attached_to, "head");
    EXPECT_EQ(fixture::hashOf(*each, 3), hash);
  }
}

TEST(Lights, FramesInFlightShowTheLightOfTheirTime) {
  Simulation prompt = fixture::panLift(lit()), late = fixture::panLift(lit(", latency_s: 0.05"));
  prompt.stepToImage("camera");
  const std::vector<std::uint8_t> expected = prompt.render(0).data;
  late.step(10);  // frame 0 is in flight
  late.setLight(lamp("position_m: [0, 0, 0.5]"));
  const std::string state = late.saveState();
  for (int run = 0; run < 2; ++run) {
    EXPECT_EQ(late.stepToImage("camera"), 0);
    EXPECT_EQ(late.render(0).data, expected) << run;
    late.restoreState(state);
  }
}

TEST(Lights, OfALinkInMotionAreBlurredWithIt) {
  const std::string on_head =
      ", {name: lamp, type: point, attached_to: head, attenuation_constant: 1.0e-9, attenuation_quadratic: 1.0, "
      "casts_shadows: false, color_rgb: [40, 40, 40]}";
  Simulation sharp = fixture::panLift(lit("", on_head)), blurred = fixture::panLift(lit(", exposure_s: 0.02", on_head));
  for (Simulation* each : {&sharp, &blurred}) {
    each->setCommand({{}, {{"lift", 0.9}}, {}});
    each->step(60);
    each->stepToImage("camera");
  }
  // The camera moves with the lamp: without its past the lamp would be as near in all samples.
  EXPECT_GT(middle(blurred), middle(sharp) + 3);  // the lamp rises: it was nearer before
}

TEST(Lights, WhatCannotBeIsNamedAndChangesNothing) {
  Simulation simulation = fixture::panLift(lit());
  const auto refusal = [&](const auto& action) -> std::string {
    try {
      action();
    } catch (const ArasError& error) {
      return error.what();
    }
    return "accepted";
  };
  EXPECT_NE(refusal([&] { simulation.deleteLight("moon"); }).find("light 'moon' does not exist; lights: sun"),
            std::string::npos);
  const std::string carrier = refusal([&] { simulation.setLight(lamp("attached_to: nowhere")); });
  EXPECT_NE(carrier.find("found nowhere, allowed"), std::string::npos) << carrier;
  EXPECT_NE(carrier.find("head"), std::string::npos) << carrier;
  EXPECT_NE(carrier.find("floor"), std::string::npos) << carrier;
  for (int k = 0; k < 7; ++k) {
    Light light = lamp("");
    light.name += std::to_string(k);
    simulation.setLight(light);
  }
  const std::string many = refusal([&] { simulation.setLight(lamp("")); });
  EXPECT_NE(many.find("found 9, allowed up to 8"), std::string::npos) << many;
  EXPECT_EQ(simulation.lights().size(), 8u);
  EXPECT_NE(
      refusal([] { fixture::panLift(lit("", ", {name: l, type: point, attached_to: no_link}")); }).find("no_link"),
      std::string::npos);
  EXPECT_NE(refusal([] { fixture::panLift(lit("", ", {name: sun, type: point}")); }).find("two named 'sun'"),
            std::string::npos);
}

}  // namespace
}  // namespace aras_visual_servo_sim::light_test
