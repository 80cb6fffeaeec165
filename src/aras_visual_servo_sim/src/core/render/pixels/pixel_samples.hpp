#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <limits>

namespace aras_visual_servo_sim {

/** 64 samples of a pixel's square, and what is nearest at each of them.
 *
 *  An 8 x 8 grid sheared both ways: the samples lie on 64 different rows and 64 different columns, so that an edge
 * along the image's axes is off by 1/128 of its contrast at most, and one at any angle by about 1/16. */
class PixelSamples {
 public:
  static constexpr int kSide = 8;
  static constexpr int kCount = kSide * kSide;
  static constexpr float kAnyDepth = std::numeric_limits<float>::max();

  /** A triangle about a pixel: x and y from its middle [px], y down. */
  struct Triangle {
    int edges;                            ///< how many of them cross the pixel; the others leave it wholly inside
    std::array<float, 3> a, b, c, least;  ///< inside where a x + b y + c >= least for each of these edges
    float z, z_x, z_y;                    ///< inverse depth in the middle and its slopes
    float most = kAnyDepth;               ///< what is nearer is not seen
  };
  /** A curved surface about a pixel: x and y as above. */
  struct Curved {
    std::array<float, 6> within;  ///< w = [0] + [1] x + [2] y + [3] x^2 + [4] x y + [5] y^2: seen where w >= 0
    std::array<float, 3> z;
    float root;                                  ///< inverse depth is [0] + [1] x + [2] y of z, + root sqrt(w)
    std::array<std::array<float, 4>, 2> bounds;  ///< seen where [0] + [1] x + [2] y + [3] times inverse depth >= 0
    float least, most;                           ///< and where the inverse depth lies between these
  };
  /** How many samples see a triangle, and the mean of their places [px]. */
  struct Share {
    int count;
    double x, y;
  };

  /** Place of a sample, from the pixel's middle [px]. */
  static Eigen::Vector2d place(int sample);
  /** Every sample sees number `nothing`. */
  void clear(std::int32_t nothing);
  /** Samples inside the triangle where it is nearer than what was seen before see number `index`. */
  void see(const Triangle& triangle, std::int32_t index);
  /** The same of a curved surface. */
  void see(const Curved& curved, std::int32_t index);
  Share shareOf(std::int32_t index) const;

 private:
  std::array<float, kCount> nearest_;  // 0: infinitely far
  std::array<std::int32_t, kCount> seen_;
};

}  // namespace aras_visual_servo_sim
