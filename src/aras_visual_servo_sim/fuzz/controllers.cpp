// The reader of controllers: ros_control's YAML, read at the start and as a controller is loaded while time goes on.
#include <aras_visual_servo_common/files.hpp>

#include "aras_visual_servo_sim/physics/managed/controller.hpp"
#include "aras_visual_servo_sim/physics/managed/joint_state_controller.hpp"
#include "aras_visual_servo_sim/robot/joint_limits_reader.hpp"
#include "small_simulation.hpp"
#include "target.hpp"

using namespace aras_visual_servo_sim;
using aras_visual_servo_common::kMostSentYaml;
using aras_visual_servo_common::parseYaml;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  static const RobotModel kArm = fuzz::smallArm();
  return fuzz::offer(bytes, size, [](const std::string& text) {
    const YAML::Node node = parseYaml(text, kMostSentYaml);
    fuzz::allow([&] { parseControllers(node, kArm); });
    fuzz::allow([&] { parseJointStates(node, kArm); });
    if (!node.IsMap()) return;
    if (node["joint_limits"].IsDefined()) {
      RobotModel limited = kArm;
      fuzz::allow([&] { applyJointLimits(node, limited); });
    }
    for (const auto& entry : node) {
      std::vector<std::string> warnings;
      fuzz::allow([&] { makeController("loaded", entry.second, kArm, warnings); });
    }
  });
}
