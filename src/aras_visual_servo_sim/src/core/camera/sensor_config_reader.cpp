#include "camera/sensor_config_reader.hpp"

#include <aras_visual_servo_common/text.hpp>

namespace aras_visual_servo_sim {
namespace {

using aras_visual_servo_common::numberText;

AutoExposureConfig readAutoExposure(YamlReader reader) {
  AutoExposureConfig config;
  config.level = reader.get<double>("level");
  config.speed = reader.get<double>("speed");
  config.delay_frames = reader.get<int>("delay_frames");
  config.min_exposure = reader.get<double>("min_exposure");
  config.max_exposure = reader.get<double>("max_exposure");
  config.max_gain = reader.get<double>("max_gain");
  return config;
}

AutoWhiteBalanceConfig readAutoWhiteBalance(YamlReader reader) {
  AutoWhiteBalanceConfig config;
  config.speed = reader.get<double>("speed");
  config.delay_frames = reader.get<int>("delay_frames");
  config.max_gain = reader.get<double>("max_gain");
  return config;
}

ThinLens readThinLens(YamlReader reader) {
  ThinLens lens;
  lens.focus_distance_m = reader.get<double>("focus_distance_m");
  lens.focal_length_m = reader.get<double>("focal_length_m");
  lens.f_number = reader.get<double>("f_number");
  return lens;
}

}  // namespace

SensorConfig readSensorConfig(YamlReader reader) {
  SensorConfig config;
  config.white_photons = reader.get<double>("white_photons");
  config.quantum_efficiency = reader.get<double>("quantum_efficiency");
  config.color_response = reader.get<std::vector<double>>("color_response");
  config.saturation_capacity_e = reader.get<double>("saturation_capacity_e");
  config.system_gain_dn_per_e = reader.find<double>("system_gain_dn_per_e");
  config.shot_noise = reader.get<bool>("shot_noise");
  config.dark_noise_e = reader.get<double>("dark_noise_e");
  config.dark_current_e_per_s = reader.get<double>("dark_current_e_per_s");
  config.prnu = reader.get<double>("prnu");
  config.dsnu_e = reader.get<double>("dsnu_e");
  config.pattern_seed = reader.get<int>("pattern_seed");
  config.black_level_dn = reader.get<double>("black_level_dn");
  config.adc_bits = reader.get<int>("adc_bits");
  config.gamma = reader.get<double>("gamma");
  config.vignetting_exponent = reader.get<double>("vignetting_exponent");
  config.defocus_px = reader.get<double>("defocus_px");
  if (reader.has("depth_of_field")) config.depth_of_field = readThinLens(reader.section("depth_of_field"));
  config.white_balance = reader.get<std::vector<double>>("white_balance");
  if (reader.has("auto_exposure")) config.auto_exposure = readAutoExposure(reader.section("auto_exposure"));
  if (reader.has("auto_white_balance")) {
    config.auto_white_balance = readAutoWhiteBalance(reader.section("auto_white_balance"));
  }
  config.row_time_s = reader.get<double>("row_time_s");
  config.jpeg_quality = reader.get<int>("jpeg_quality");
  return config;
}

void checkSensor(const SensorConfig& sensor, const std::string& encoding, FaultList& faults) {
  if (sensor.black_level_dn >= sensor.mostDn()) {
    faults.add("sensor/black_level_dn", numberText(sensor.black_level_dn),
               "< 2^adc_bits - 1, " + numberText(sensor.mostDn()));
  }
  if (const auto& lens = sensor.depth_of_field; lens) {
    if (lens->focal_length_m >= lens->focus_distance_m) {
      faults.add("sensor/depth_of_field/focal_length_m", numberText(lens->focal_length_m),
                 "< focus_distance_m, " + numberText(lens->focus_distance_m));
    }
    if (sensor.defocus_px > 0.0) {
      faults.add("sensor/defocus_px", numberText(sensor.defocus_px), "0 beside depth_of_field");
    }
  }
  if (sensor.jpeg_quality > 0 && (encoding == "mono16" || encoding == "rgb16")) {
    faults.add("sensor/jpeg_quality", numberText(sensor.jpeg_quality),
               "0 with " + encoding + ": JPEG has 8 bits a value");
  }
  if (sensor.auto_white_balance && (encoding == "mono8" || encoding == "mono16")) {
    faults.add("sensor/auto_white_balance", "a section", "none with " + encoding + ", which has no colours");
  }
}

}  // namespace aras_visual_servo_sim
