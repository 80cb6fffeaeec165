// The readers of the section `vision`, and of a camera and its lens as text.
#include <aras_visual_servo_common/files.hpp>

#include "aras_visual_servo_camera/config/vision_config.hpp"
#include "aras_visual_servo_camera/image/camera_intrinsics.hpp"
#include "target.hpp"

using namespace aras_visual_servo_camera;
namespace common = aras_visual_servo_common;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  fuzz::allow([&] {
    const std::string text(reinterpret_cast<const char*>(bytes), size);
    const YAML::Node node = common::parseYaml(text, common::kMostSentYaml);
    fuzz::allow([&] { readVisionConfig(node); });
    fuzz::allow([&] { readCameraInfo(node); });
  });
  return 0;
}
