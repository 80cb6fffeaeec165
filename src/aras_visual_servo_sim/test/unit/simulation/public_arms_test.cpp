// Arms of the sizes of public ones, as their users write them: transmissions, safety controllers, a gripper that
// mimics, a camera tag; held against gravity by their controllers.
#include "aras_visual_servo_sim/simulation/simulation.hpp"
#include "tools/physics_tools.hpp"

namespace aras_visual_servo_sim::public_arms_test {
namespace {

YAML::Node controllersOf(int axes) {
  YAML::Node controllers;
  for (int k = 1; k <= axes; ++k) {
    const std::string joint = "joint" + std::to_string(k);
    controllers[joint + "_position"] = YAML::Load("{type: effort_controllers/JointPositionController, joint: " + joint +
                                                  ", pid: {p: 2000, i: 500, d: 60, i_clamp: 60}}");
  }
  controllers["gripper"] = YAML::Load("{type: position_controllers/JointPositionController, joint: left_finger_joint}");
  return controllers;
}

void holdsAndSees(const std::string& file, int axes, const std::string& positions) {
  const YAML::Node config =
      YAML::Load("{initial_positions: " + positions +
                 ", scene: {solids: [{name: floor, box_m: [2, 2, 0.1], position_m: [0, 0, -0.1]}]}}");
  Simulation simulation(modelOf(readUrdf(file)), SimulationConfig::fromYaml(config), controllersOf(axes));
  for (const std::string& warning : simulation.model().warnings) {
    EXPECT_EQ(warning.find("ignored"), std::string::npos) << warning;
  }
  const Eigen::VectorXd start = simulation.body().jointPositions();
  simulation.setControllerCommand("gripper", 0.03);
  simulation.step(1000);
  const auto& names = simulation.model().joint_names;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const double q = simulation.body().jointPositions()[static_cast<int>(i)];
    if (names[i].find("finger") != std::string::npos) {
      EXPECT_NEAR(q, 0.03, 1e-4) << names[i];  // both: the right one mimics
    } else {
      // At most the weight on the first axes, 70 N m, over the proportional gain.
      EXPECT_NEAR(q, start[static_cast<int>(i)], 70.0 / 2000.0) << names[i];
    }
  }
  ASSERT_EQ(simulation.cameras().names(), std::vector<std::string>{"camera"});
  const Image& image = simulation.render(0);
  EXPECT_EQ(image.width, 64);
}

TEST(PublicArms, SevenAxesAndAGripper) {
  holdsAndSees("seven_axis_gripper.urdf", 7,
               "{joint1: 0.1, joint2: -0.7, joint3: 0.1, joint4: -2.3, joint5: 0.1, joint6: 1.6, joint7: 0.7}");
}

TEST(PublicArms, SixAxesAndAGripper) {
  holdsAndSees("six_axis_gripper.urdf", 6,
               "{joint1: 0.2, joint2: -1.2, joint3: 1.4, joint4: -1.7, joint5: -1.5, joint6: 0.1}");
}

}  // namespace
}  // namespace aras_visual_servo_sim::public_arms_test
