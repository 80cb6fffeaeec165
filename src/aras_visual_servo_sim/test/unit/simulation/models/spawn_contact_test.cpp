// What comes while the simulation runs and can be touched.
#include <gtest/gtest.h>

#include <string>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "aras_visual_servo_sim/scene/scene_loader.hpp"
#include "tools/pan_lift.hpp"

namespace aras_visual_servo_sim::spawn_contact_test {
namespace {

constexpr double kHalf = 0.05,
                 kNear = 1e-4;  // half the edge of a box; what a spring gives way under these weights, and more
const char* const kGround = "contacts: {ground_plane: {z_m: 0.0}}";
const char* const kCube = "{name: cube, box_m: [0.1, 0.1, 0.1], mass_kg: 0.5, touches: all, position_m: [1, 0, 0.25]}";
const char* const kPlate = "{name: plate, box_m: [0.3, 0.3, 0.1], touches: all, position_m: [1, 0, 0.05]}";
const char* const kTable =
    "<robot name='table'><link name='leg'><collision><geometry><box size='0.05 0.05 "
    "0.1'/></geometry></collision></link>"
    "<link name='top'><visual><geometry><box size='0.3 0.3 0.02'/></geometry></visual>"
    "<collision><geometry><box size='0.3 0.3 0.02'/></geometry></collision></link>"
    "<joint name='j' type='fixed'><parent link='leg'/><child link='top'/><origin xyz='0 0 0.06'/></joint></robot>";

double heightOf(const Simulation& simulation, const std::string& model) {
  return simulation.models().pose(model).p.z();
}

TEST(SpawnedContacts, ABoxWithMassFallsLiesAndIsGoneAgain) {
  Simulation simulation = fixture::panLift(kGround);
  simulation.step(100);
  simulation.spawnModel(YAML::Load(kCube));
  simulation.step(100);
  const double fallen = 0.5 * 9.81 * 0.1 * 0.101;  // n (n + 1) / 2 steps of g dt^2
  EXPECT_NEAR(heightOf(simulation, "cube"), 0.25 - fallen, 1e-12);
  EXPECT_NEAR(simulation.modelTwist("cube")[2], -0.981, 1e-12);
  simulation.step(900);
  EXPECT_NEAR(heightOf(simulation, "cube"), kHalf, kNear);
  EXPECT_NEAR(simulation.modelTwist("cube").norm(), 0.0, 1e-9);
  simulation.deleteModel("cube");
  simulation.step(10);
  EXPECT_THROW(simulation.models().pose("cube"), UnknownNameError);
}

TEST(SpawnedContacts, WhatLiesOnAThingFallsWhenTheThingIsDeleted) {
  Simulation simulation = fixture::panLift(kGround);
  simulation.spawnModel(YAML::Load(kPlate));
  simulation.spawnModel(YAML::Load(kCube));
  simulation.step(1000);
  EXPECT_NEAR(heightOf(simulation, "cube"), 0.1 + kHalf, kNear);
  simulation.deleteModel("plate");
  simulation.step(1000);
  EXPECT_NEAR(heightOf(simulation, "cube"), kHalf, kNear);
}

TEST(SpawnedContacts, ADescriptionWithoutVisualsCanBeTouchedAndOneWithNeitherIsRefused) {
  Simulation simulation = fixture::panLift(kGround);
  const std::string link = "<robot name='r'><link name='l'>", shape = "<geometry><box size='0.3 0.3 0.1'/></geometry>";
  YAML::Node floor;
  floor["name"] = "floor";
  floor["touches"] = "all";
  floor["position_m"] = std::vector<double>{1.0, 0.0, 0.05};
  floor["urdf"] = link + "</link></robot>";
  EXPECT_THROW(simulation.spawnModel(floor), ModelError);
  floor["urdf"] = link + "<collision>" + shape + "</collision></link></robot>";
  simulation.spawnModel(floor);
  simulation.spawnModel(YAML::Load(kCube));
  simulation.step(1000);
  EXPECT_NEAR(heightOf(simulation, "cube"), 0.1 + kHalf, kNear);
}

TEST(SpawnedContacts, WhatIsOnlySeenComesAndGoesWithoutAnyChangeOfTheContacts) {
  Simulation one = fixture::panLift(kGround), other = fixture::panLift(kGround);
  for (Simulation* each : {&one, &other}) {
    each->spawnModel(YAML::Load(kCube));
    each->step(150);
    if (each == &one) continue;
    each->spawnModel(modelEntry("sign",
                                "<robot name='s'><link name='l'><visual><geometry><sphere radius='0.1'/></geometry>"
                                "</visual></link></robot>"));
    each->step(10);
    each->deleteModel("sign");
  }
  one.step(10);
  EXPECT_EQ(one.models().pose("cube").p, other.models().pose("cube").p);
  EXPECT_EQ(one.modelTwist("cube"), other.modelTwist("cube"));
}

TEST(SpawnedContacts, BodiesThatFallGoOnFallingWhenOthersComeAndGo) {
  const auto boxAt = [](const std::string& name, double x_m, double z_m) {
    return YAML::Load("{name: " + name + ", box_m: [0.1, 0.1, 0.1], mass_kg: 0.5, touches: all, position_m: [" +
                      std::to_string(x_m) + ", 0, " + std::to_string(z_m) + "]}");
  };
  Simulation one = fixture::panLift(kGround), other = fixture::panLift(kGround);
  for (Simulation* each : {&one, &other}) {
    each->spawnModel(boxAt("first", 1.0, 0.8));
    each->spawnModel(boxAt("second", 2.0, 0.9));
    each->step(50);
    // What is touched changes, so the bodies are made anew, in another order: each takes its own place and velocity.
    if (each == &other) {
      each->spawnModel(boxAt("third", 3.0, 0.5));
      each->step(50);
      each->deleteModel("first");
      each->step(50);
    } else {
      each->step(100);
    }
  }
  EXPECT_EQ(one.models().pose("second").p, other.models().pose("second").p);
  EXPECT_EQ(one.modelTwist("second"), other.modelTwist("second"));
  EXPECT_NEAR(other.modelTwist("third")[2], -0.981, 1e-12);
  EXPECT_NEAR(one.modelTwist("second")[2], -1.4715, 1e-12);
}

TEST(SpawnedContacts, WithPairsAllADescriptionTouchesByItsCollisionShapes) {
  Simulation simulation = fixture::panLift("contacts: {pairs: all}");
  simulation.spawnModel(modelEntry("table", kTable), Pose{{1.0, 0.0, 0.05}, Eigen::Quaterniond::Identity()});
  simulation.spawnModel(YAML::Load("{name: ball, sphere_m: 0.05, mass_kg: 0.5, position_m: [1, 0, 0.3]}"));
  simulation.step(1000);
  EXPECT_NEAR(heightOf(simulation, "ball"), 0.05 + 0.07 + 0.05, kNear);
  simulation.setModelPose("table", Pose{{1.0, 0.0, 0.03}, Eigen::Quaterniond::Identity()});  // both shapes go along
  simulation.step(1000);
  EXPECT_NEAR(heightOf(simulation, "ball"), 0.03 + 0.07 + 0.05, kNear);
}

TEST(SpawnedContacts, AMovedOneCarriesWhatLiesOnIt) {
  Simulation simulation = fixture::panLift();  // no sim/contacts at all: `touches` is enough
  simulation.spawnModel(YAML::Load(kPlate));
  simulation.spawnModel(YAML::Load(kCube));
  simulation.step(1000);
  simulation.setModelMotion("plate",
                            ModelMotion::fromYaml(YAML::Load("{type: constant_velocity, linear_m_per_s: [0, 0, 0.05],"
                                                             " angular_rad_per_s: [0, 0, 0]}"),
                                                  "motion"));
  simulation.step(1000);
  EXPECT_NEAR(heightOf(simulation, "plate"), 0.05 + 0.05, 1e-4);
  EXPECT_NEAR(heightOf(simulation, "cube") - heightOf(simulation, "plate"), 2.0 * kHalf, 1e-3);
}

TEST(SpawnedContacts, ResetForgetsThemAndTheWorldsResetBringsThemBack) {
  Simulation simulation = fixture::panLift(kGround);
  const auto run = [&] {
    for (int k = 0; k < 5; ++k) simulation.stepToImage("camera");
    return simulation.runHash();
  };
  const std::string fresh = run();
  simulation.spawnModel(YAML::Load(kCube));
  simulation.step(500);
  simulation.resetWorld();
  EXPECT_EQ(heightOf(simulation, "cube"), 0.25);
  EXPECT_EQ(simulation.modelTwist("cube").norm(), 0.0);
  simulation.reset();
  EXPECT_EQ(run(), fresh);
}

TEST(SpawnedContacts, AreInTheSavedState) {
  Simulation simulation = fixture::panLift(kGround);
  simulation.spawnModel(YAML::Load(kPlate));
  simulation.spawnModel(YAML::Load(kCube));
  simulation.step(80);  // falling
  const std::string state = simulation.saveState();
  simulation.step(300);
  const std::string later = simulation.saveState();
  Simulation other = fixture::panLift(kGround);
  other.restoreState(state);
  other.step(300);
  EXPECT_EQ(other.saveState(), later);
  simulation.deleteModel("cube");
  simulation.restoreState(state);
  simulation.step(300);
  EXPECT_EQ(simulation.saveState(), later);
}

TEST(SpawnedContacts, OneOfTheSceneCanGoAndComeBack) {
  Simulation simulation = fixture::panLift(
      "{contacts: {ground_plane: {}, pairs: [[plate, cube]], free_bodies: {cube: 0.5}}, scene: {solids: ["
      "{name: plate, box_m: [0.3, 0.3, 0.1], position_m: [1, 0, 0.05]},"
      "{name: cube, box_m: [0.1, 0.1, 0.1], position_m: [1, 0, 0.2]}]}}");
  simulation.deleteModel("plate");
  simulation.step(1000);
  EXPECT_NEAR(heightOf(simulation, "cube"), kHalf, kNear);
  simulation.deleteModel("cube");
  simulation.reset();
  simulation.step(1000);
  EXPECT_NEAR(heightOf(simulation, "cube"), 0.1 + kHalf, kNear);
}

TEST(SpawnedContacts, RefusalsNameTheCauseAndChangeNothing) {
  Simulation simulation = fixture::panLift();
  const auto refusal = [&](const std::string& entry) -> std::string {
    try {
      simulation.spawnModel(YAML::Load(entry));
    } catch (const ArasError& error) {
      return error.what();
    }
    return "accepted";
  };
  EXPECT_NE(refusal("{name: a, sphere_m: 0.1, touches: [tabel]}").find("touches: found tabel, allowed all, robot, a"),
            std::string::npos);
  EXPECT_NE(refusal("{name: a, sphere_m: 0.1, touches: {b: c}}")
                .find("touches: found {b: c}, allowed a text or a list of 0 to 1000 texts"),
            std::string::npos);
  EXPECT_NE(refusal("{name: a, sphere_m: 0.1, mass_kg: 1}").find("nothing to touch"), std::string::npos);
  EXPECT_NE(refusal("{name: a, sphere_m: 0.1, mass_kg: -1, touches: all}").find("mass_kg: found -1"),
            std::string::npos);
  EXPECT_NE(refusal("{name: a, urdf: x.urdf, mass_kg: 1, touches: all}").find("it together with urdf"),
            std::string::npos);
  EXPECT_EQ(simulation.models().names(), std::vector<std::string>{"target"});
  simulation.step(10);
}

}  // namespace
}  // namespace aras_visual_servo_sim::spawn_contact_test
