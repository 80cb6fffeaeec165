#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "aras_visual_servo_camera/image/object_mask.hpp"

namespace aras_visual_servo_camera {

/** How far a side of an object may lie from where the weights of its edge pixels put it (docs/theory.md T73).
 *
 *  A weight is known in steps only: one grey level, a share of the samples that a pixel was drawn by, or, where pixels
 *  count as inside or outside, the whole pixel. Neighbours that fall on the same step err alike, and so does a side on
 *  which all of them do; where they differ, by a slope of the side or by noise, their errors average. */
class EdgeStep {
 public:
  /** Forget the weights of earlier images. */
  void forget();

  /** @param objects  in the mask
   *  @return standard deviation of the place of a side [px], half a step where all its pixels err alike; NaN for a mask
   *  without an object */
  double process(const ObjectMask& mask, int objects);

 private:
  static constexpr int kBins = 32;

  /** A partly covered pixel, and the weight by which the more alike of its neighbours on the right and below differs
   * from it. A run of pixels ends where that is large. */
  struct Partly {
    double weight, difference;
  };

  /** Sets pixels_. */
  void compare(const std::vector<EdgePixel>& edge);
  /** Whether the object has moved since this last said so. */
  bool hasMoved(const ObjectMask& mask);
  /** Counts the weights of pixels_, one of each run. */
  void take();
  /** The widest interval of weights in which hardly any were seen so far; 0 while there were too few to tell. */
  double gap() const;

  std::array<std::size_t, kBins> seen_{};  // number of runs by their weight
  std::array<double, 3> last_{};           // place and size of the object when it moved last [px]
  std::size_t count_ = 0;
  std::vector<Partly> pixels_;  // of the image at hand
};

}  // namespace aras_visual_servo_camera
