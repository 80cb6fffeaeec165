#pragma once

#include <optional>
#include <vector>

#include "aras_visual_servo_sim/image/sensor/thin_lens.hpp"

namespace aras_visual_servo_sim {

/** How a camera chooses its exposure by itself, see AutoExposure. */
struct AutoExposureConfig {
  double level = 0.0, speed = 0.0;
  int delay_frames = 0;
  double min_exposure = 0.0, max_exposure = 0.0, max_gain = 0.0;
};

/** How a camera chooses the gains of red and blue by itself, see AutoWhiteBalance. */
struct AutoWhiteBalanceConfig {
  double speed = 0.0;
  int delay_frames = 0;
  double max_gain = 0.0;
};

/** A sensor in the words of EMVA 1288; schema/sensor.yaml says what each key means and what it may be. */
struct SensorConfig {
  double white_photons = 0.0, quantum_efficiency = 0.0;
  std::vector<double> color_response;  ///< of red, green and blue
  double saturation_capacity_e = 0.0;
  std::optional<double> system_gain_dn_per_e;
  double dark_noise_e = 0.0, dark_current_e_per_s = 0.0;
  bool shot_noise = true;
  double prnu = 0.0, dsnu_e = 0.0;
  int pattern_seed = 0;
  double black_level_dn = 0.0;
  int adc_bits = 0;
  double gamma = 0.0;
  double vignetting_exponent = 0.0, defocus_px = 0.0;
  std::optional<ThinLens> depth_of_field;
  std::vector<double> white_balance;  ///< gains of red, green and blue
  std::optional<AutoExposureConfig> auto_exposure;
  std::optional<AutoWhiteBalanceConfig> auto_white_balance;
  double row_time_s = 0.0;
  int jpeg_quality = 0;  ///< 0: none

  /** The largest digital number. */
  double mostDn() const { return static_cast<double>((1 << adc_bits) - 1); }
  /** K: without a given one, a full pixel is the largest digital number. */
  double systemGain() const {
    return system_gain_dn_per_e.value_or((mostDn() - black_level_dn) / saturation_capacity_e);
  }
};

}  // namespace aras_visual_servo_sim
