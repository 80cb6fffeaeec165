#include "segmentation/covered_part.hpp"

#include <algorithm>
#include <cmath>

namespace aras_visual_servo_camera {

// The smaller part of the pixel, of area `part`, lies at the corner to which the gradient points (or, if it is the part
// that is not covered, at the opposite one). X and Y are measured from that corner, X along the steeper axis; the line
// is X + slope Y = p, slope 0 to 1. It cuts off a triangle, or a trapezoid over the whole of 0 < Y < 1.
PixelPoint centroidOfCoveredPart(double weight, double gradient_u, double gradient_v) {
  const double across = std::abs(gradient_u), along = std::abs(gradient_v);
  const double steep = std::max(across, along);
  if (!(weight > 0.0 && weight < 1.0 && steep > 0.0)) return {};
  const double slope = std::min(across, along) / steep, part = std::min(weight, 1.0 - weight);
  double X, Y;
  if (part < 0.5 * slope) {
    const double p = std::sqrt(2.0 * slope * part);
    X = p / 3.0;
    Y = X / slope;
  } else {
    X = 0.5 * part + slope * slope / (24.0 * part);
    Y = 0.5 - slope / (12.0 * part);
  }
  // The centroid of both parts together is the centre of the pixel.
  const double scale = part / weight, to_steep = scale * (0.5 - X), to_other = scale * (0.5 - Y);
  return {std::copysign(across >= along ? to_steep : to_other, gradient_u),
          std::copysign(across >= along ? to_other : to_steep, gradient_v)};
}

}  // namespace aras_visual_servo_camera
