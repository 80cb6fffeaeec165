#pragma once

#include <array>
#include <limits>

namespace aras_visual_servo_sim {

/** The Kannala-Brandt lens: "equidistant" of sensor_msgs/CameraInfo, OpenCV's fisheye model (Kannala and Brandt, IEEE
 *  PAMI 28(8), 2006).
 *
 *  A ray at an angle theta from the optical axis meets the image at
 *  r(theta) = theta (1 + k1 theta^2 + k2 theta^4 + k3 theta^6 + k4 theta^8) focal lengths from the principal point, in
 *  the direction of its own x and y. The formula has no limit at 90 degrees: with theta = atan2(sqrt(X^2 + Y^2), Z) it
 * holds for points beside and behind the camera too. */
class EquidistantLens {
 public:
  /** [rad] from the axis, 125 degrees: nothing farther is ever drawn. */
  static constexpr double kWidest = 2.18;

  EquidistantLens() = default;
  /** @param coefficients  k1 k2 k3 k4, finite */
  explicit EquidistantLens(const std::array<double, 4>& coefficients);

  /** The least angle at which r stops growing [rad], as far as kWidest; infinity if there is none. */
  double fold() const { return fold_; }
  /** Up to this angle rays are drawn: the least of kWidest, the fold and the cut-off [rad]. */
  double reach() const { return reach_; }
  /** @param angle  the cut-off: no ray beyond it is drawn [rad], > 0 */
  void cutOff(double angle);

  /** r(theta) [focal lengths]; beyond reach() continued along the tangent there, so that it never folds over.
   *  @param theta  0 .. pi */
  double radius(double theta) const;
  /** The inverse of radius, at most pi. @param r  >= 0 */
  double angle(double r) const;

 private:
  double polynomial(double theta) const;
  double slope(double theta) const;

  std::array<double, 4> k_{};
  double fold_ = std::numeric_limits<double>::infinity();
  double reach_ = kWidest;
  double edge_radius_ = kWidest, edge_slope_ = 1.0;  // at reach_
};

}  // namespace aras_visual_servo_sim
