#include "aras_visual_servo_sim/physics/managed/controller_set.hpp"

#include "aras_visual_servo_sim/config/errors.hpp"
#include "tools/two_joints.hpp"

namespace aras_visual_servo_sim::controller_set_test {
namespace {

const char* const kPosition = "{type: effort_controllers/JointPositionController, joint: a, pid: {p: 500, d: 20}}";
const char* const kGroup = "{type: effort_controllers/JointGroupEffortController, joints: [b, a]}";

MultibodyWorld worldOf(const std::string& interface) {
  WorldConfig config = weightless();
  config.hold_idle_joints = true;
  return MultibodyWorld(twoJoints(interface), config);
}

void load(MultibodyWorld& world, const std::string& name, const std::string& yaml) {
  world.loadController(name, YAML::Load(yaml));
}

template <typename E = ParameterError>
std::string refusal(MultibodyWorld& world, const std::vector<std::string>& start,
                    const std::vector<std::string>& stop) {
  return messageOf<E>([&] { world.switchControllers(start, stop, true); });
}

std::string states(const MultibodyWorld& world) {
  std::string text;
  for (const auto& entry : world.controllers().entries()) text += entry.controller->name() + " " + entry.state() + ", ";
  return text;
}

TEST(ControllerSet, OnlyWhatIsStartedActs) {
  MultibodyWorld world = worldOf("EffortJointInterface");
  load(world, "pan", kPosition);
  world.step(10);
  EXPECT_EQ(states(world), "pan initialized, ");
  EXPECT_EQ(world.jointEfforts()[0], 0.0);
  world.switchControllers({"pan"}, {}, true);
  world.setControllerCommand("pan", 0.5);
  world.step(1500);
  EXPECT_EQ(states(world), "pan running, ");
  EXPECT_NEAR(world.jointPositions()[0], 0.5, 1e-3);
  world.switchControllers({}, {"pan"}, true);
  EXPECT_EQ(states(world), "pan stopped, ");
  EXPECT_THROW(world.setControllerCommand("pan", 0.1), UnknownNameError);
  world.unloadController("pan");
  EXPECT_EQ(states(world), "");
}

TEST(ControllerSet, AnswersAsAControllerManagerWhatCannotBeSwitched) {
  MultibodyWorld world = worldOf("EffortJointInterface");
  load(world, "pan", kPosition);
  load(world, "both", kGroup);
  EXPECT_HAS(refusal<UnknownNameError>(world, {"nobody"}, {}), "Could not start controller with name 'nobody' because");
  EXPECT_HAS(refusal<UnknownNameError>(world, {}, {"nobody"}), "Could not stop controller with name 'nobody' because");
  EXPECT_HAS(refusal(world, {}, {"pan"}), "since it is not running");
  EXPECT_HAS(refusal(world, {"pan", "both"}, {}), "due to resource conflict: joint 'a' is claimed by 'pan' and 'both'");
  world.switchControllers({"pan"}, {}, true);
  EXPECT_HAS(refusal(world, {"pan"}, {}), "Controller 'pan' is already running");
  EXPECT_HAS(refusal(world, {"pan"}, {"pan"}), "conflicting switching command");
  EXPECT_HAS(refusal(world, {"both"}, {}), "due to resource conflict");
  EXPECT_HAS(messageOf<ParameterError>([&] { world.unloadController("pan"); }), "because it is still running");
  EXPECT_EQ(states(world), "pan running, both initialized, ");
  world.switchControllers({"both"}, {"pan"}, true);
  EXPECT_EQ(states(world), "pan stopped, both running, ");
}

TEST(ControllerSet, BestEffortDoesWhatCanBeDone) {
  MultibodyWorld world = worldOf("EffortJointInterface");
  load(world, "pan", kPosition);
  world.switchControllers({"nobody", "pan"}, {"pan", "somebody"}, false);
  EXPECT_EQ(states(world), "pan running, ");
}

TEST(ControllerSet, RefusesToLoadWhatItDoesNotKnow) {
  MultibodyWorld world = worldOf("EffortJointInterface");
  const auto refused = [&world](const std::string& yaml) {
    return messageOf<ParameterError>([&] { load(world, "c", yaml); });
  };
  EXPECT_HAS(refused("{}"), "found no parameter 'c/type'");
  EXPECT_HAS(refused("{type: fancy/Controller}"), "found type fancy/Controller, allowed is one of effort_controllers/");
  EXPECT_HAS(refused("{type: effort_controllers/JointEffortController, joint: x}"),
             "allowed a moving joint: one of a, b");
  EXPECT_HAS(refused("{type: position_controllers/JointPositionController, joint: a}"), "PositionJointInterface");
  EXPECT_HAS(refused("{type: position_controllers/JointTrajectoryController, joints: [a]}"),
             "could not find joint 'a' in 'hardware_interface::PositionJointInterface': its <transmission> says "
             "EffortJointInterface");
  EXPECT_HAS(refused("{type: joint_state_controller/JointStateController}"), "Parameter 'publish_rate' not set");
  load(world, "c", kPosition);
  EXPECT_HAS(refused(kPosition), "A controller named 'c' was already loaded inside the controller manager");
}

TEST(ControllerSet, IgnoresParametersThatATypeDoesNotHaveAndSaysSo) {
  MultibodyWorld world = worldOf("EffortJointInterface");
  const auto warnings = world.loadController(
      "c", YAML::Load("{type: effort_controllers/JointTrajectoryController, joints: [a], required_drive_mode: 1}"));
  ASSERT_EQ(warnings.size(), 2u);
  EXPECT_HAS(warnings[0], "c/required_drive_mode: ignored");
  EXPECT_HAS(warnings[1], "c/gains/a: is missing");
}

TEST(ControllerSet, AGroupTakesOneNumberForEachOfItsJoints) {
  MultibodyWorld world = worldOf("EffortJointInterface");
  load(world, "both", kGroup);
  world.switchControllers({"both"}, {}, true);
  world.setGroupCommand("both", {0.3, -0.2});
  world.step();
  EXPECT_NEAR(world.jointEfforts()[0], -0.2, 1e-12);
  EXPECT_NEAR(world.jointEfforts()[1], 0.3, 1e-12);
  EXPECT_HAS(messageOf<ParameterError>([&] { world.setGroupCommand("both", {1.0}); }),
             "Dimension of command (1) does not match number of joints (2)! Not executing!");
  EXPECT_THROW(world.setGroupCommand("both", {1.0, std::nan("")}), NotFiniteError);
}

TEST(ControllerSet, PositionJointsStayWhereTheyAreWhileNothingRuns) {
  WorldConfig config;  // with gravity
  config.hold_idle_joints = true;
  RobotModel model = twoJoints("PositionJointInterface");
  config.gravity_m_s2 = {0.0, -9.81, 0.0};
  MultibodyWorld world(model, config);
  load(world, "both", "{type: position_controllers/JointGroupPositionController, joints: [b, a]}");
  world.step(100);
  EXPECT_NEAR(world.jointPositions()[0], 0.0, 1e-9);
  world.switchControllers({"both"}, {}, true);
  world.setGroupCommand("both", {0.5, 0.4});
  world.step(500);
  world.switchControllers({}, {"both"}, true);
  world.step(500);
  EXPECT_NEAR(world.jointPositions()[0], 0.4, 1e-9);
  EXPECT_NEAR(world.jointPositions()[1], 0.5, 1e-9);
}

TEST(ControllerSet, AResetOfTheWorldStartsRunningControllersAnew) {
  MultibodyWorld world = worldOf("PositionJointInterface");
  load(world, "both", "{type: position_controllers/JointGroupPositionController, joints: [b, a]}");
  world.switchControllers({"both"}, {}, true);
  world.setGroupCommand("both", {0.5, 0.4});
  world.step(300);
  world.reset(vectorOf({0.1, 0.2}));
  world.step(300);
  EXPECT_EQ(states(world), "both running, ");
  EXPECT_NEAR(world.jointPositions()[0], 0.1, 1e-9);
}

TEST(ControllerSet, ASavedStateOfOtherControllersIsRestoredWithThem) {
  MultibodyWorld one = worldOf("EffortJointInterface"), other = worldOf("EffortJointInterface");
  load(one, "pan", kPosition);
  one.switchControllers({"pan"}, {}, true);
  one.setControllerCommand("pan", 0.5);
  one.step(100);
  load(other, "both", kGroup);
  other.switchControllers({"both"}, {}, true);
  other.restoreState(one.saveState());
  EXPECT_EQ(states(other), "pan running, ");
  one.step(200);
  other.step(200);
  EXPECT_EQ(one.saveState(), other.saveState());
  std::string cut = one.saveState();
  cut.pop_back();
  EXPECT_THROW(other.restoreState(cut), StateError);
}

TEST(ControllerSet, AParameterWhoseNameIsAListIsIgnoredByName) {
  std::vector<std::string> warnings;
  const auto controller = makeController(
      "pan", YAML::Load("{type: effort_controllers/JointPositionController, joint: a, pid: {p: 500}, [d]: 20}"),
      twoJoints("EffortJointInterface"), warnings);
  EXPECT_EQ(controller->name(), "pan");
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_HAS(warnings[0], "pan/[d]: ignored, this type of controller has no such parameter");
}

}  // namespace
}  // namespace aras_visual_servo_sim::controller_set_test
