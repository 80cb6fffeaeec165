#include "aras_visual_servo_sim/camera/camera_config_reader.hpp"

#include "aras_visual_servo_sim/camera/camera_model.hpp"

namespace aras_visual_servo_sim {

CameraConfig readCameraConfig(YamlReader& reader) {
  CameraConfig camera;
  const auto number = [&reader](const char* key, std::optional<double>& value) {
    if (reader.has(key)) value = reader.required<double>(key);
  };
  camera.name = reader.required<std::string>("name");
  camera.frame = reader.required<std::string>("frame");
  camera.width = reader.required<int>("width");
  camera.height = reader.required<int>("height");
  number("horizontal_fov_rad", camera.horizontal_fov_rad);
  number("fx_px", camera.fx_px);
  number("fy_px", camera.fy_px);
  number("cx_px", camera.cx_px);
  number("cy_px", camera.cy_px);
  number("cutoff_angle_rad", camera.cutoff_angle_rad);
  camera.distortion_model = reader.optional<std::string>("distortion_model", camera.distortion_model);
  camera.distortion = reader.optional<std::vector<double>>("distortion", {});
  camera.rate_hz = reader.optional<double>("rate_hz", camera.rate_hz);
  camera.encoding = reader.optional<std::string>("encoding", camera.encoding);
  camera.near_m = reader.optional<double>("near_m", camera.near_m);
  camera.far_m = reader.optional<double>("far_m", camera.far_m);
  camera.sampling = reader.optional<std::string>("sampling", camera.sampling);
  camera.noise_mean = reader.optional<double>("noise_mean", camera.noise_mean);
  camera.exposure_s = reader.optional<double>("exposure_s", camera.exposure_s);
  camera.exposure_samples = reader.optional<int>("exposure_samples", camera.exposure_samples);
  camera.latency_s = reader.optional<double>("latency_s", camera.latency_s);
  camera.drop_probability = reader.optional<double>("drop_probability", camera.drop_probability);
  camera.triggered = reader.optional<bool>("triggered", camera.triggered);
  camera.baseline_m = reader.optional<double>("baseline_m", camera.baseline_m);
  camera.noise_stddev = reader.optional<double>("noise_stddev", camera.noise_stddev);
  return camera;
}

CameraConfig cameraConfigFromYaml(const YAML::Node& node) {
  YamlReader reader(node);
  const CameraConfig camera = readCameraConfig(reader);
  reader.finish();
  CameraModel{camera};  // its ranges
  return camera;
}

}  // namespace aras_visual_servo_sim
