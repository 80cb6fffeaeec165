#pragma once

#include <algorithm>
#include <cmath>

#include "aras_visual_servo_sim/config/sections.hpp"

namespace aras_visual_servo_sim {

/** A lens of one focal length and an aperture, focused at a distance, before pixels of one size.
 *
 *  With the focal length f and the f-number N the aperture is f / N wide. Light of a point at the depth d meets behind
 *  the lens at v(d) = f d / (d - f), the sensor stands at v(focus): there the cone of light has the diameter
 *  (f / N) |v(focus) - v(d)| / v(d). A camera's focal length in pixels is v(focus) over the width of a pixel, so that
 *  this is focal_px (f / N) |1 / focus - 1 / d| pixels. */
struct ThinLens : DepthOfFieldConfig {
  double focal_px = 0.0;  ///< the camera's, of camera_info

  /** Diameter of the disc that a point is spread over. @param depth_m  > 0; not a number: infinitely far */
  double diameterPx(double depth_m) const {
    const double nearness = std::isnan(depth_m) ? 0.0 : 1.0 / depth_m;
    return std::min(kMostPx, focal_px * focal_length_m / f_number * std::abs(1.0 / focus_distance_m - nearness));
  }
  static constexpr double kMostPx = 64.0;  ///< no disc is larger
};

}  // namespace aras_visual_servo_sim
