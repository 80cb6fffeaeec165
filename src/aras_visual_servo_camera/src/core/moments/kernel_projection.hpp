#pragma once

#include <vector>

#include "aras_visual_servo_camera/image/object_mask.hpp"
#include "aras_visual_servo_camera/image/pixel_map.hpp"
#include "aras_visual_servo_camera/moments/moment_features.hpp"

namespace aras_visual_servo_camera {

/** Projections of an object onto the kernels X^-p and Y^-q, with X = x - x0, Y = y - y0 from a corner outside the
 * image.
 *
 *  kernel_x holds p, x0, and the integrals over the object of X^-(p - 1 + k) y^j dA at [2 + 2 k + j], k = 0, 1, 2 and
 *  j = 0, 1; kernel_y the same of Y^-(q - 1 + k) x^j. The projections themselves are those of k = 1, j = 0; the others
 *  make their interaction rows exact (docs/theory.md T47). Each weight counts at the centre of its pixel. */
class KernelProjection {
 public:
  /** @param map  must outlive this. @param p, q  exponents, > 0 */
  KernelProjection(const PixelMap& map, double p, double q);

  /** Puts both into the features of this mask; empty where there is no target. */
  void write(const ObjectMask& mask, MomentFeatures* features) const;

 private:
  struct Powers {
    double x, y;  // X^-(p + 1), Y^-(q + 1)
  };

  const PixelMap& map_;
  double p_, q_, x0_ = 0.0, y0_ = 0.0;
  std::vector<Powers> powers_;  // of each pixel, row-major
};

}  // namespace aras_visual_servo_camera
