#include "aras_visual_servo_sim/camera/camera_config_reader.hpp"

#include "aras_visual_servo_sim/camera/camera_model.hpp"
#include "aras_visual_servo_sim/image/sensor/sensor_config.hpp"

namespace aras_visual_servo_sim {
namespace {

/** Checks keys of a camera that may come from elsewhere than YAML. */
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
  void operator()(const char*, const std::optional<SensorConfig>&) const {}  // comes from YAML alone
};

}  // namespace

CameraConfig cameraConfigFromYaml(const YAML::Node& node) {
  const CameraConfig camera{readSection<CameraKeys>(node, "", [](auto&&...) {}), {}, {}, {}};
  CameraModel{camera};  // checks what a schema cannot express
  return camera;
}

void checkKeys(const CameraConfig& camera, FaultList& faults) {
  CameraKeys::visitKeys(camera, Checking{CameraKeys::schema(), faults});
}

void checkSensor(const SensorConfig& sensor, const std::string& encoding, FaultList& faults) {
  if (sensor.black_level_dn >= mostDn(sensor)) {
    faults.add("sensor.black_level_dn", numberText(sensor.black_level_dn),
               "< 2^adc_bits - 1, " + numberText(mostDn(sensor)));
  }
  if (const auto& lens = sensor.depth_of_field; lens) {
    if (lens->focal_length_m >= lens->focus_distance_m) {
      faults.add("sensor.depth_of_field.focal_length_m", numberText(lens->focal_length_m),
                 "< focus_distance_m, " + numberText(lens->focus_distance_m));
    }
    if (sensor.defocus_px > 0.0) {
      faults.add("sensor.defocus_px", numberText(sensor.defocus_px), "0 beside depth_of_field");
    }
  }
  if (sensor.jpeg_quality > 0 && (encoding == "mono16" || encoding == "rgb16")) {
    faults.add("sensor.jpeg_quality", numberText(sensor.jpeg_quality),
               "0 with " + encoding + ": JPEG has 8 bits a value");
  }
  if (sensor.auto_white_balance && (encoding == "mono8" || encoding == "mono16")) {
    faults.add("sensor.auto_white_balance", "a section", "none with " + encoding + ", which has no colours");
  }
}

}  // namespace aras_visual_servo_sim
