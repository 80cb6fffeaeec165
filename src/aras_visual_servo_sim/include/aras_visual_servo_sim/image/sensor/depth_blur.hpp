#pragma once

#include <cstdint>
#include <vector>

#include "aras_visual_servo_sim/image/image.hpp"
#include "aras_visual_servo_sim/image/sensor/thin_lens.hpp"

namespace aras_visual_servo_sim {

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
