// The reader of the section `sim` of a scenario: physics, contacts, cameras, scene.
#include <aras_visual_servo_common/files.hpp>

#include "aras_visual_servo_sim/simulation/simulation_config.hpp"
#include "target.hpp"

using namespace aras_visual_servo_sim;
using aras_visual_servo_common::kMostSentYaml;
using aras_visual_servo_common::parseYaml;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  return fuzz::offer(bytes, size,
                     [](const std::string& text) { SimulationConfig::fromYaml(parseYaml(text, kMostSentYaml)); });
}
