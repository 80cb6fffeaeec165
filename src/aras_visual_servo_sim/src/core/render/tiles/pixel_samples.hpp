#pragma once

#include <array>
#include <cstdint>

namespace aras_visual_servo_sim {

/** 64 samples of a pixel's square, and what is nearest at each of them.
 *
 *  An 8 x 8 grid sheared both ways: the samples lie on 64 different rows and 64 different columns, so that an edge
 * along the image's axes is off by 1/128 of its contrast at most, and one at any angle by about 1/16. */
class PixelSamples {
 public:
  static constexpr int kSide = 8;
  static constexpr int kCount = kSide * kSide;

  /** A triangle about a pixel: x and y from its middle [px], y down. */
  struct Triangle {
    std::array<float, 3> a, b, c, least;  ///< inside where a x + b y + c >= least for all three edges
    float z, z_x, z_y;                    ///< inverse depth in the middle and its slopes
  };
  /** How many samples see a triangle, and the mean of their places [px]. */
  struct Share {
    int count;
    double x, y;
  };

  /** Every sample sees number `nothing`. */
  void clear(std::int32_t nothing);
  /** Samples inside the triangle where it is nearer than what was seen before see number `index`. */
  void see(const Triangle& triangle, std::int32_t index);
  Share shareOf(std::int32_t index) const;

 private:
  std::array<float, kCount> nearest_;  // 0: infinitely far
  std::array<std::int32_t, kCount> seen_;
};

}  // namespace aras_visual_servo_sim
