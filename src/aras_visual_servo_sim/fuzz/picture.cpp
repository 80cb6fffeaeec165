// The reader of pictures for targets and meshes.
#include "aras_visual_servo_sim/image/texture.hpp"
#include "target.hpp"

using namespace aras_visual_servo_sim;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  fuzz::allow([&] { loadTexture("fuzz", bytes, size); });
  return 0;
}
