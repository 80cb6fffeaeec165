#include <gtest/gtest.h>

#include <string>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "aras_visual_servo_sim/scene/scene_loader.hpp"
#include "tools/pan_lift.hpp"

namespace aras_visual_servo_sim::spawn_test {
namespace {

const char* const kBox = "{name: box, box_m: [0.05, 0.05, 0.05], position_m: [0.1, 0, 0.1], color_rgb: [200, 0, 0]}";
const char* const kTable =
    "<robot name='table'><link name='top'><visual><geometry><box size='0.2 0.1 0.02'/></geometry></visual></link>"
    "<link name='leg'><visual><geometry><cylinder radius='0.01' length='0.1'/></geometry></visual></link>"
    "<joint name='j' type='fixed'><parent link='top'/><child link='leg'/><origin xyz='0.05 0 -0.06' rpy='1.5 0 0'/>"
    "</joint></robot>";

TEST(SpawnedModels, AreSeenPlacedAndGoneAgain) {
  Simulation simulation = fixture::panLift();
  const std::vector<std::uint8_t> before = simulation.render(0).data;
  simulation.spawnModel(YAML::Load(kBox));
  EXPECT_EQ(simulation.models().names(), (std::vector<std::string>{"target", "box"}));
  EXPECT_NE(simulation.render(0).data, before);
  simulation.setModelPose("box", Pose{{9.0, 0.0, 0.0}, Eigen::Quaterniond::Identity()});
  EXPECT_EQ(simulation.render(0).data, before);
  simulation.deleteModel("box");
  EXPECT_EQ(simulation.models().names(), std::vector<std::string>{"target"});
  EXPECT_THROW(simulation.deleteModel("box"), UnknownNameError);
}

TEST(SpawnedModels, LookAsIfTheyHadBeenThereFromTheStart) {
  Simulation spawned = fixture::panLift();
  spawned.spawnModel(YAML::Load(kBox));
  Simulation built = fixture::panLift(
      "scene: {background_rgb: [230, 230, 230], models: [{name: target, color_rgb: [20, 20, 20],"
      " outlines_m: [[[-0.1, -0.05], [0.1, -0.05], [0.1, 0.05], [-0.1, 0.05]]]}], solids: [" +
      std::string(kBox) + "]}");
  EXPECT_EQ(spawned.render(0).data, built.render(0).data);
}

TEST(SpawnedModels, ResetBringsBackTheSceneOfTheConfiguration) {
  Simulation simulation = fixture::panLift();
  const std::string fresh = fixture::hashOf(simulation, 4);
  simulation.spawnModel(YAML::Load(kBox));
  simulation.deleteModel("target");
  EXPECT_NE(fixture::hashOf(simulation, 4), fresh);
  simulation.reset();
  EXPECT_EQ(simulation.models().names(), std::vector<std::string>{"target"});
  EXPECT_EQ(fixture::hashOf(simulation, 4), fresh);
}

TEST(SpawnedModels, AreInTheSavedState) {
  Simulation simulation = fixture::panLift();
  simulation.spawnModel(modelEntry("table", kTable), Pose{{0.0, 0.05, 0.1}, quaternionFromRpy({0.1, 0.2, 0.3})});
  YAML::Node box = YAML::Load(kBox);
  box["motion"] = YAML::Load("{type: circle, radius_m: 0.05, angular_speed_rad_per_s: 3.0}");
  fixture::hashOf(simulation, 2);
  simulation.spawnModel(box);
  simulation.deleteModel("target");
  fixture::hashOf(simulation, 2);
  const std::string state = simulation.saveState();
  const std::string later = fixture::hashOf(simulation, 5);
  simulation.reset();
  simulation.restoreState(state);
  EXPECT_EQ(simulation.models().names(), (std::vector<std::string>{"table", "box"}));
  EXPECT_EQ(fixture::hashOf(simulation, 5), later);
  Simulation other = fixture::panLift();
  other.restoreState(state);
  EXPECT_EQ(fixture::hashOf(other, 5), later);
  other.reset();
  EXPECT_EQ(other.models().names(), std::vector<std::string>{"target"});
}

TEST(SpawnedModels, StateOfAnotherSceneIsRefusedByName) {
  Simulation other = fixture::panLift("scene: {solids: [" + std::string(kBox) + "]}");
  Simulation simulation = fixture::panLift();
  try {
    simulation.restoreState(other.saveState());
    FAIL() << "was accepted";
  } catch (const StateError& error) {
    EXPECT_NE(std::string(error.what()).find("box"), std::string::npos) << error.what();
  }
  EXPECT_EQ(simulation.models().names(), std::vector<std::string>{"target"});
}

TEST(SpawnedModels, RefusalsNameTheCauseAndChangeNothing) {
  Simulation simulation = fixture::panLift();
  EXPECT_THROW(simulation.spawnModel(YAML::Load("{name: target, sphere_m: 0.1}")), ParameterError);
  EXPECT_THROW(simulation.spawnModel(YAML::Load("{name: ball, sphere_m: -0.1}")), ParameterError);
  EXPECT_THROW(simulation.spawnModel(YAML::Load("[1, 2]")), ParameterError);
  EXPECT_THROW(simulation.spawnModel(modelEntry("a", "no/such/file.stl")), ModelError);
  EXPECT_THROW(modelEntry("a", "  \n"), ParameterError);
  EXPECT_THROW(modelEntry("a", "{name: ["), ParameterError);
  const std::string moving =
      "<robot name='r'><link name='a'/><link name='b'/><joint name='hinge' type='continuous'><parent link='a'/>"
      "<child link='b'/></joint></robot>";
  try {
    simulation.spawnModel(modelEntry("door", moving));
    FAIL() << "was accepted";
  } catch (const ModelError& error) {
    EXPECT_NE(std::string(error.what()).find("hinge"), std::string::npos) << error.what();
  }
  EXPECT_EQ(simulation.models().names(), std::vector<std::string>{"target"});
}

TEST(SpawnedModels, LinksOfAStaticUrdfAreWhereItsJointsPutThem) {
  const Body table = bodyFromUrdf("table", kTable, PackagePaths());
  ASSERT_EQ(table.shapes.size(), 2U);
  EXPECT_EQ(table.shapes[1].X_BS.p, Eigen::Vector3d(0.05, 0.0, -0.06));
  EXPECT_NEAR(table.shapes[1].X_BS.q.angularDistance(quaternionFromRpy({1.5, 0.0, 0.0})), 0.0, 1e-7);  // acos near 1
}

TEST(ModelEntry, TellsDescriptionsApart) {
  EXPECT_TRUE(modelEntry("a", kTable)["urdf"].IsDefined());
  EXPECT_TRUE(modelEntry("a", "package://p/a.urdf")["urdf"].IsDefined());
  EXPECT_TRUE(modelEntry("a", "package://p/a.yaml")["file"].IsDefined());
  EXPECT_TRUE(modelEntry("a", "package://p/a.DAE")["mesh"].IsDefined());
  EXPECT_TRUE(modelEntry("a", "meshes/a.stl")["mesh"].IsDefined());
  EXPECT_TRUE(modelEntry("a", "sphere_m: 0.1")["sphere_m"].IsDefined());
  EXPECT_EQ(modelEntry("a", "{name: b, sphere_m: 0.1}")["name"].as<std::string>(), "a");
}

}  // namespace
}  // namespace aras_visual_servo_sim::spawn_test
