#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "aras_visual_servo_sim/config/sections.hpp"
#include "aras_visual_servo_sim/image/image.hpp"

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

/** Spreads each pixel over the disc of its own depth.
 *
 *  A pixel becomes the mean of those whose discs reach it, weighted by what of their discs lies in it. What is farther
 *  away than the pixel itself is spread no wider than the pixel, for the nearer thing hides the rest of that disc: the
 *  background does not shine into a sharp thing before it. Discs are as wide as a multiple of 1/8 px. */
class DepthBlur {
 public:
  explicit DepthBlur(const ThinLens& lens) : lens_(lens) {}

  /** @param depth_m  of each pixel, row by row; not a number: nothing is there, infinitely far */
  void apply(const std::vector<float>& depth_m, FineImage& image);

 private:
  struct Disc {
    int reach = 0;
    std::vector<float> shares;  // empty: not made yet
  };
  const Disc& disc(int step);
  int reachAbout(int u, int v) const;
  void findReaches(int width, int height);

  ThinLens lens_;
  std::vector<Disc> discs_;           // by their diameters' multiple of the step
  std::vector<std::uint16_t> steps_;  // of each pixel
  std::vector<int> reaches_;          // how far pixels of other blocks, or its own, may reach into each block
  int blocks_u_ = 0;
};

}  // namespace aras_visual_servo_sim
