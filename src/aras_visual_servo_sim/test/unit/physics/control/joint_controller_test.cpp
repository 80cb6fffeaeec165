#include "aras_visual_servo_sim/physics/joint_controller.hpp"

#include <limits>
#include <utility>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "tools/physics_tools.hpp"

namespace aras_visual_servo_sim::joint_controller_test {
namespace {

std::vector<ControllerConfig> parsed(const std::string& yaml) {
  return parseControllers(YAML::Load(yaml), modelOf(readUrdf("two_link_full.urdf")));
}

std::string refusal(const std::string& yaml) {
  return messageOf<ParameterError>([&] { parsed(yaml); });
}

TEST(Controllers, ReadsRosControlsLayout) {
  const auto configs = parsed(R"(
joint_state: {type: joint_state_controller/JointStateController, publish_rate: 50}
swing: {type: effort_controllers/JointPositionController, joint: b_swing,
        pid: {p: 100, i: 2, d: 3.5, i_clamp: -4, antiwindup: true, publish_state: true}}
slide: {type: position_controllers/JointPositionController, joint: a_slide, command_timeout_s: 0.25}
not_a_controller: {value: 3}
number: 4
)");
  ASSERT_EQ(configs.size(), 2u);
  EXPECT_EQ(configs[0].name, "swing");
  EXPECT_EQ(configs[0].type, ControllerType::kEffortPosition);
  EXPECT_EQ(configs[0].joint, "b_swing");
  EXPECT_EQ(configs[0].gains.p, 100.0);
  EXPECT_EQ(configs[0].gains.i, 2.0);
  EXPECT_EQ(configs[0].gains.d, 3.5);
  EXPECT_EQ(configs[0].gains.i_min, -4.0);
  EXPECT_EQ(configs[0].gains.i_max, 4.0);
  EXPECT_TRUE(configs[0].gains.antiwindup);
  EXPECT_TRUE(configs[0].publish_state);
  EXPECT_EQ(configs[1].type, ControllerType::kPosition);
  EXPECT_EQ(configs[1].command_timeout_s, 0.25);
}

TEST(Controllers, EachTypeIsReadAsWhatItsNameSays) {
  const std::vector<std::pair<std::string, ControllerType>> types = {
      {"effort_controllers/JointPositionController", ControllerType::kEffortPosition},
      {"effort_controllers/JointVelocityController", ControllerType::kEffortVelocity},
      {"effort_controllers/JointEffortController", ControllerType::kEffort},
      {"position_controllers/JointPositionController", ControllerType::kPosition},
      {"velocity_controllers/JointVelocityController", ControllerType::kVelocity}};
  for (const auto& [name, type] : types) {
    const std::string pid = name.find("effort_controllers/JointE") == 0 || name[0] != 'e' ? "" : ", pid: {p: 1}";
    // Joints without a transmission take every type.
    const auto configs = parseControllers(YAML::Load("{c: {type: " + name + ", joint: swing" + pid + "}}"),
                                          modelOf(readUrdf("pendulum.urdf")));
    ASSERT_EQ(configs.size(), 1u) << name;
    EXPECT_EQ(configs[0].type, type) << name;
    EXPECT_EQ(controllerTypeName(type), name);
  }
}

TEST(Controllers, GainsThatChangeAreCheckedOneByOne) {
  const auto fault = [](const PidGains& gains) {
    return messageOf<ParameterError>([&] { checkGains(gains, "swing"); });
  };
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  EXPECT_HAS(fault({-1, 0, 0, 0, 0, false}), "swing.pid.p: found -1");
  EXPECT_HAS(fault({1, -1, 0, 0, 0, false}), "swing.pid.i: found -1");
  EXPECT_HAS(fault({1, 0, -1, 0, 0, false}), "swing.pid.d: found -1");
  EXPECT_HAS(fault({1, 0, 0, 1, 1, false}), "swing.pid.i_clamp_min: found 1");
  EXPECT_HAS(fault({1, 0, 0, -kInfinity, 1, false}), "swing.pid.i_clamp_min: found -inf");
  EXPECT_HAS(fault({1, 0, 0, -1, -1, false}), "swing.pid.i_clamp_max: found -1");
  EXPECT_HAS(fault({1, 0, 0, -1, kInfinity, false}), "swing.pid.i_clamp_max: found inf");
  EXPECT_NO_THROW(checkGains({1, 2, 3, -1, 1, true}, "swing"));
}

TEST(Controllers, AMissingJointIsSaidOnce) {
  const std::string message = refusal("{e: {type: effort_controllers/JointEffortController}}");
  EXPECT_HAS(message, "e.joint: found nothing");
  EXPECT_EQ(message.find("e.joint"), message.rfind("e.joint")) << message;
}

TEST(Controllers, IClampMinAndMaxGoBeforeIClamp) {
  const auto configs = parsed(
      "{c: {type: effort_controllers/JointVelocityController, joint: b_swing, pid: {p: 1, i_clamp: 5, i_clamp_min: "
      "2}}}");
  EXPECT_EQ(configs[0].gains.i_min, -2.0);
  EXPECT_EQ(configs[0].gains.i_max, 5.0);
}

TEST(Controllers, AllFaultsAreListedAtOnce) {
  const std::string message = refusal(R"(
a: {type: effort_controllers/JointPositionController, joint: b_swing, pid: {d: 1}}
b: {type: effort_controllers/JointPositionController, joint: nowhere, pid: {p: -1}}
c: {type: trajectory/Fancy, joint: a_slide}
d: {type: effort_controllers/JointEffortController, joint: b_swing}
e: {type: effort_controllers/JointEffortController}
f: {type: effort_controllers/JointPositionController, joint: a_slide}
g: {type: effort_controllers/JointVelocityController, joint: a_slide, pid: {p: 1, q: 2}}
)");
  EXPECT_HAS(message, "a.pid.p: found nothing, allowed a number (required)");
  EXPECT_HAS(message, "b.pid.p: found -1, allowed >= 0");
  EXPECT_HAS(message, "b.joint: found nowhere, allowed a moving joint: one of a_slide, b_swing");
  EXPECT_HAS(message, "c.type: found trajectory/Fancy, allowed one of joint_state_controller/JointStateController");
  EXPECT_HAS(message, "d.joint: found b_swing, allowed a joint no other controller has (a has it)");
  EXPECT_HAS(message, "e.joint: found nothing");
  EXPECT_HAS(message, "f.pid: found nothing, allowed a map (required)");
  EXPECT_HAS(message, "g.pid.q: found an unknown key");
}

TEST(Controllers, ADocumentThatIsNoMapIsRefused) { EXPECT_HAS(refusal("[1, 2]"), "allowed a map of controllers"); }

TEST(Controllers, ANameThatIsAListIsAName) {
  const auto configs = parsed("{[a, b]: {type: position_controllers/JointPositionController, joint: a_slide}}");
  ASSERT_EQ(configs.size(), 1u);
  EXPECT_EQ(configs[0].name, "[a, b]");
}

}  // namespace
}  // namespace aras_visual_servo_sim::joint_controller_test
