#pragma once

#include <optional>
#include <vector>

#include "aras_visual_servo_camera/image/object_mask.hpp"

namespace aras_visual_servo_camera {

/** Numbers of a shape that no affine map changes: they do not depend on scale and rotation, and hardly on the direction
 * from which it is seen (docs/theory.md T38). A disc has (1, 0, 0), every rectangle has (1.047, 0, 0). */
struct ShapeSignature {
  double spread;    ///< 4 pi sqrt(mu20 mu02 - mu11^2) / m00^2, 1 for an ellipse and more for everything else
  double c21, c30;  ///< moduli of the complex third-order moments, the second-order ones made a unit circle
};

/** @param m00  area. @param mu  centred moments in the sequence of moments.hpp, to order 3 at least, of any coordinates
 *  @return nothing for a line or a point */
std::optional<ShapeSignature> shapeOf(double m00, const std::vector<double>& mu);

/** The same numbers from the pixels of a mask, without undoing the lens. */
std::optional<ShapeSignature> shapeOf(const ObjectMask& mask);

/** Distance of two signatures, 0 for equal shapes. */
double dissimilarity(const ShapeSignature& a, const ShapeSignature& b);

}  // namespace aras_visual_servo_camera
