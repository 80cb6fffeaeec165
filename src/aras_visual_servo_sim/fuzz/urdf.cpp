// The reader of robot models: the text of a URDF.
#include "aras_visual_servo_sim/robot/urdf_loader.hpp"
#include "target.hpp"

using namespace aras_visual_servo_sim;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  return fuzz::offer(bytes, size, [](const std::string& text) { loadRobotModel(text, "fuzz.urdf"); });
}
