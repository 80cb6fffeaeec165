#include "aras_visual_servo_camera/photometric_config.hpp"

#include <algorithm>

#include "aras_visual_servo_camera/yaml_reader.hpp"

namespace aras_visual_servo_camera {

PhotometricConfig readPhotometricConfig(const YAML::Node& node) {
  constexpr int kMaxLevels = 8, kMaxBorder_px = 1 << 14;
  YamlReader reader(node, "vision/photometric");
  PhotometricConfig c;
  c.interaction = static_cast<GradientOf>(
      reader.optionalChoice("interaction", {"desired", "current", "mean"}, static_cast<int>(c.interaction)));
  c.illumination = static_cast<Illumination>(reader.optionalChoice(
      "illumination", {"constant", "offset", "gain_and_offset"}, static_cast<int>(c.illumination)));
  c.levels = reader.optionalInteger("levels", 1, kMaxLevels, c.levels);
  c.switch_px = reader.optionalNumber("switch_px", 0.01, 100.0, c.switch_px);
  c.smoothing_px = reader.optionalNumber("smoothing_px", 0.5, 20.0, c.smoothing_px);
  c.border_px = reader.optionalInteger("border_px", 0, kMaxBorder_px, c.border_px);
  c.min_contrast = reader.optionalNumber("min_contrast", 0.0, 127.0, c.min_contrast);
  const std::vector<double> normal = reader.optionalNumbers("target_normal_C");
  if (normal.size() == 3 && normal[2] > 0.0) {
    std::copy_n(normal.begin(), 3, c.target_normal_C.begin());
  } else if (reader.has("target_normal_C")) {
    reader.fault("target_normal_C", "another vector", "three numbers, the last > 0 (away from the camera)");
  }
  reader.finish();
  return c;
}

}  // namespace aras_visual_servo_camera
