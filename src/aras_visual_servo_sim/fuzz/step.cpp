// What steps: the text of a URDF, as a robot that moves for some periods, held or floating.
#include "aras_visual_servo_sim/physics/multibody_world.hpp"
#include "aras_visual_servo_sim/robot/urdf_loader.hpp"
#include "target.hpp"

using namespace aras_visual_servo_sim;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  return fuzz::offer(bytes, size, [](const std::string& text) {
    const RobotModel robot = loadRobotModel(text, "fuzz.urdf");
    for (const Base base : {Base::kFromModel, Base::kFloating}) {
      WorldConfig config;
      config.base = base;
      fuzz::allow([&] {
        MultibodyWorld world(robot, config);
        world.step(3);
        if (!world.jointPositions().allFinite() || !world.jointVelocities().allFinite()) __builtin_trap();
      });
    }
  });
}
