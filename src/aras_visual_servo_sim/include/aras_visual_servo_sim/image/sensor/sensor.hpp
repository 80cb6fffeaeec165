#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "aras_visual_servo_sim/config/sections.hpp"
#include "aras_visual_servo_sim/image/image.hpp"
#include "aras_visual_servo_sim/image/sensor/depth_blur.hpp"

namespace aras_visual_servo_sim {

/** The largest digital number of a sensor. */
inline double mostDn(const SensorConfig& sensor) { return static_cast<double>((1 << sensor.adc_bits) - 1); }

/** From the light that falls on a sensor to the bytes of an image, as EMVA Standard 1288 describes a linear camera:
 *
 *      electrons = Poisson(white_photons * quantum_efficiency * light + dark current), at most saturation_capacity_e
 *      digital number = black_level_dn + K * (electrons + pattern + noise of reading), rounded and clipped once
 *
 *  before that vignetting and defocus, after it white balance, gamma and JPEG. Noise depends on the seed, the frame's
 *  index and the place alone; what the camera sets by itself depends on State. */
class Sensor {
 public:
  /** @param encoding      of the image
   *  @param cosines       of the angles between the pixels' rays and the optical axis, row by row; read if the config
   *                       has a vignetting_exponent, else empty
   *  @param integration_s  during which the dark current flows [s]
   *  @param pattern_seed  tells this sensor from others of its kind
   *  @param focal_px  of camera_info, for depth_of_field */
  Sensor(const SensorConfig& config, int width, int height, Encoding encoding, const std::vector<float>& cosines,
         double integration_s, std::uint64_t seed, std::uint64_t pattern_seed, double focal_px = 0.0);

  const SensorConfig& config() const { return config_; }

  /** Whether light has to go through focus() before it is read out. */
  bool seesDepth() const { return depth_blur_.has_value(); }
  /** Spreads light by its distance. @param depth_m  of each pixel; not a number: infinitely far @pre seesDepth() */
  void focus(const std::vector<float>& depth_m, FineImage& light) { depth_blur_->apply(depth_m, light); }

  /** @param light  rgb8 for a Bayer pattern, else of the image's channels; changed  @param image  resized
   *  @param fresh  the frame is read out for the first time: what the camera sets by itself moves on */
  void readOut(FineImage& light, std::uint64_t frame_index, bool fresh, Image& image);

  /** What the camera has set by itself. */
  struct State {
    double brightness = 1.0;                       ///< of the frame read out last
    std::array<double, 2> balance{1.0, 1.0};       ///< its gains of red and blue
    std::deque<double> brightnesses;               ///< of the frames to come
    std::deque<std::array<double, 2>> balances{};  ///< of the frames to come
  };
  /** Whether there is a state to keep. */
  bool setsItself() const { return config_.auto_exposure || config_.auto_white_balance; }
  const State& state() const { return state_; }
  void restore(State state);

 private:
  void takeSettings();
  void digitise(const FineImage& light, std::uint64_t frame_index);
  void meter();
  template <typename Value>
  void develop(Image& image) const;

  SensorConfig config_;
  std::optional<DepthBlur> depth_blur_;
  int width_, height_;
  Encoding encoding_;
  double dark_e_;
  std::uint64_t seed_;
  std::array<std::vector<std::uint8_t>, 2> colors_;  // of the values of even and odd rows
  std::vector<float> response_;                      // electrons of white, value by value
  std::vector<float> offset_e_;                      // empty: none
  std::vector<std::uint16_t> tones_;                 // of each digital number: see toneCurve
  State state_;
  FineImage mosaic_;
  std::vector<std::uint16_t> numbers_;
};

}  // namespace aras_visual_servo_sim
