#include "aras_visual_servo_sim/physics/managed/velocity_position_controller.hpp"

#include "aras_visual_servo_sim/config/errors.hpp"
#include "tools/two_joints.hpp"

namespace aras_visual_servo_sim::velocity_position_controller_test {
namespace {

struct Axis {
  explicit Axis(const std::string& pid) : world(twoJoints("VelocityJointInterface"), weightless()) {
    world.loadController(
        "axis", YAML::Load("{type: velocity_controllers/JointPositionController, joint: a, pid: " + pid + "}"));
    world.switchControllers({"axis"}, {}, true);
  }
  MultibodyWorld world;
};

TEST(VelocityPositionController, MovesWithTheGainTimesTheError) {
  Axis axis("{p: 2.0}");
  axis.world.setControllerCommand("axis", 0.1);
  axis.world.step(1);
  EXPECT_NEAR(axis.world.jointVelocities()[0], 2.0 * 0.1, 1e-9);
  axis.world.step(999);
  EXPECT_NEAR(0.1 - axis.world.jointPositions()[0], 0.1 * std::pow(1.0 - 2.0 * 1e-3, 1000), 1e-6);
  const ControllerState state = axis.world.controllerState("axis");
  EXPECT_EQ(state.set_point, 0.1);
  EXPECT_NEAR(state.command, 2.0 * state.error, 1e-12);
}

TEST(VelocityPositionController, TakesGainsAndKeepsThemInASavedState) {
  Axis axis("{p: 2.0}"), other("{p: 2.0}");
  axis.world.setGains("axis", PidGains{20.0, 0.0, 0.0, 0.0, 0.0, false});
  axis.world.setControllerCommand("axis", 0.1);
  axis.world.step(10);
  other.world.restoreState(axis.world.saveState());
  for (Axis* each : {&axis, &other}) each->world.step(100);
  EXPECT_EQ(other.world.jointPositions()[0], axis.world.jointPositions()[0]);
  EXPECT_EQ(other.world.controllerState("axis").gains.p, 20.0);
  EXPECT_THROW(axis.world.setControllerCommand("axis", std::nan("")), NotFiniteError);
  EXPECT_THROW(axis.world.setGains("axis", PidGains{-1.0, 0.0, 0.0, 0.0, 0.0, false}), ParameterError);
}

TEST(VelocityPositionController, NeedsAVelocityJointAndGains) {
  MultibodyWorld effort(twoJoints("EffortJointInterface"), weightless());
  const std::string type = "{type: velocity_controllers/JointPositionController, joint: a";
  EXPECT_THROW(effort.loadController("axis", YAML::Load(type + ", pid: {p: 1}}")), ParameterError);
  MultibodyWorld velocity(twoJoints("VelocityJointInterface"), weightless());
  EXPECT_THROW(velocity.loadController("axis", YAML::Load(type + "}")), ParameterError);
}

}  // namespace
}  // namespace aras_visual_servo_sim::velocity_position_controller_test
