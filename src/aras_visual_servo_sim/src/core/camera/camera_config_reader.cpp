#include "aras_visual_servo_sim/camera/camera_config_reader.hpp"

#include "aras_visual_servo_sim/camera/camera_model.hpp"
#include "camera/sensor_config_reader.hpp"

namespace aras_visual_servo_sim {
namespace {

const char kSection[] = "camera";

/** Hands each key of the section with its member to a visitor. */
template <typename Config, typename Visitor>
void visitKeys(Config& camera, Visitor&& visit) {
  visit("name", camera.name);
  visit("frame", camera.frame);
  visit("width", camera.width);
  visit("height", camera.height);
  visit("horizontal_fov_rad", camera.horizontal_fov_rad);
  visit("fx_px", camera.fx_px);
  visit("fy_px", camera.fy_px);
  visit("cx_px", camera.cx_px);
  visit("cy_px", camera.cy_px);
  visit("distortion_model", camera.distortion_model);
  visit("distortion", camera.distortion);
  visit("cutoff_angle_rad", camera.cutoff_angle_rad);
  visit("rate_hz", camera.rate_hz);
  visit("encoding", camera.encoding);
  visit("near_m", camera.near_m);
  visit("far_m", camera.far_m);
  visit("sampling", camera.sampling);
  visit("renderer", camera.renderer);
  visit("quality", camera.quality);
  visit("exact_targets", camera.exact_targets);
  visit("gl", camera.gl);
  visit("noise_mean", camera.noise_mean);
  visit("noise_stddev", camera.noise_stddev);
  visit("exposure_s", camera.exposure_s);
  visit("exposure_samples", camera.exposure_samples);
  visit("latency_s", camera.latency_s);
  visit("drop_probability", camera.drop_probability);
  visit("triggered", camera.triggered);
  visit("baseline_m", camera.baseline_m);
}

struct Reading {
  YamlReader& reader;
  template <typename T>
  void operator()(const char* key, T& value) const {
    value = reader.get<T>(key);
  }
  void operator()(const char* key, std::optional<double>& value) const { value = reader.find<double>(key); }
};

struct SettingDefaults {
  const Schema& section;
  template <typename T>
  void operator()(const char* key, T& value) const {
    if (section.property(YAML::Node(), key)->default_value) value = defaultOf<T>(kSection, key);
  }
  void operator()(const char*, std::optional<double>&) const {}  // an absent value follows from other keys
};

struct Checking {
  const Schema& section;
  FaultList& faults;
  template <typename T>
  void operator()(const char* key, const T& value) const {
    checkValue(section, key, value, faults);
  }
  void operator()(const char* key, const std::string& value) const {
    const bool is_choice = !section.property(YAML::Node(), key)->choices.empty();
    if (is_choice) checkValue(section, key, value, faults);  // any text is allowed as a name, also ""
  }
  void operator()(const char* key, const std::optional<double>& value) const {
    if (value) checkValue(section, key, *value, faults);
  }
  void operator()(const char*, bool) const {}
};

}  // namespace

CameraConfig::CameraConfig() { visitKeys(*this, SettingDefaults{sectionOf(kSection)}); }

CameraConfig readCameraConfig(YamlReader& reader) {
  CameraConfig camera;
  visitKeys(camera, Reading{reader});
  if (reader.has("sensor")) camera.sensor = readSensorConfig(reader.section("sensor"));
  return camera;
}

CameraConfig cameraConfigFromYaml(const YAML::Node& node) {
  YamlReader reader(node, sectionOf(kSection));
  const CameraConfig camera = readCameraConfig(reader);
  reader.finish();
  CameraModel{camera};  // checks what a schema cannot express
  return camera;
}

void checkKeys(const CameraConfig& camera, FaultList& faults) {
  visitKeys(camera, Checking{sectionOf(kSection), faults});
}

}  // namespace aras_visual_servo_sim
