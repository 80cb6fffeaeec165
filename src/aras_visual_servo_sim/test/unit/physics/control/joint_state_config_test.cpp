#include "aras_visual_servo_sim/config/errors.hpp"
#include "aras_visual_servo_sim/physics/managed/joint_state_controller.hpp"
#include "tools/physics_tools.hpp"

namespace aras_visual_servo_sim::joint_state_config_test {
namespace {

JointStateConfig parse(const std::string& entry) {
  return parseJointStates(YAML::Load("{gains: {p: 1}, states: " + entry + "}"),
                          modelOf(readUrdf("two_link_full.urdf")));
}

const std::string kType = "type: joint_state_controller/JointStateController";

TEST(JointStateConfig, HasTheRateAndTheExtraJointsOfTheFile) {
  const JointStateConfig config = parse(
      "{" + kType + ", publish_rate: 50, extra_joints: [{name: wheel, position: 0.1, velocity: 0.2, effort: 0.3}, " +
      "{name: b_swing, position: 9}, {name: wheel, position: 8}, {name: caster}]}");
  EXPECT_EQ(config.publish_rate_hz, 50.0);
  ASSERT_EQ(config.extra_joints.size(), 2u) << "a joint of the robot and one given before are passed over";
  EXPECT_EQ(config.extra_joints[0].name, "wheel");
  EXPECT_EQ(config.extra_joints[0].position, 0.1);
  EXPECT_EQ(config.extra_joints[0].velocity, 0.2);
  EXPECT_EQ(config.extra_joints[0].effort, 0.3);
  EXPECT_EQ(config.extra_joints[1].name, "caster");
  EXPECT_EQ(config.extra_joints[1].position, 0.0);
}

TEST(JointStateConfig, WithoutAControllerOrItsRateThereIsNone) {
  EXPECT_FALSE(parse("{" + kType + "}").publish_rate_hz);
  EXPECT_FALSE(parse("{}").publish_rate_hz);
}

TEST(JointStateConfig, FaultsNameTheKey) {
  try {
    parse("{" + kType + ", publish_rate: 0, extra_joints: [{position: fast}], rate: 3}");
    FAIL() << "accepted";
  } catch (const ParameterError& error) {
    const std::string text = error.what();
    for (const char* part : {"states.publish_rate: found 0, allowed > 0", "states.extra_joints[0].name",
                             "states.extra_joints[0].position: found fast", "states.rate"}) {
      EXPECT_NE(text.find(part), std::string::npos) << part << " is not in\n" << text;
    }
  }
}

TEST(JointStateConfig, ANameThatIsAListIsReadAndAListOfControllersHasNone) {
  const RobotModel model = modelOf(readUrdf("two_link_full.urdf"));
  EXPECT_EQ(parseJointStates(YAML::Load("{[a, b]: {" + kType + ", publish_rate: 20}}"), model).publish_rate_hz, 20.0);
  EXPECT_FALSE(parseJointStates(YAML::Load("[{" + kType + ", publish_rate: 20}]"), model).publish_rate_hz);
  EXPECT_FALSE(parseJointStates(YAML::Node(), model).publish_rate_hz);
}

}  // namespace
}  // namespace aras_visual_servo_sim::joint_state_config_test
