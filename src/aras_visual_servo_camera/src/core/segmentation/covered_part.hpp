#pragma once

namespace aras_visual_servo_camera {

/** A point of a pixel, from its centre, -1/2 to 1/2 [px]. */
struct PixelPoint {
  double u = 0.0, v = 0.0;
};

/** Centroid of the part of a pixel that an object covers, where its edge is a straight line through the pixel (T63).
 *
 *  The line lies across the gradient of the coverage, where the covered area is the pixel's weight.
 *  @param weight  covered area, 0 to 1 [px^2]
 *  @param gradient_u, gradient_v  direction in which the coverage grows, of any length
 *  @return the centre of the pixel where the weight is 0 or 1 or there is no gradient */
PixelPoint centroidOfCoveredPart(double weight, double gradient_u, double gradient_v);

}  // namespace aras_visual_servo_camera
