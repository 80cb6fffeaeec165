#include "aras_visual_servo_sim/camera/equidistant_lens.hpp"

#include <algorithm>
#include <cmath>

namespace aras_visual_servo_sim {

EquidistantLens::EquidistantLens(const std::array<double, 4>& coefficients) : k_(coefficients) {
  constexpr double kStep = 1e-3;  // [rad]: two turning points nearer than this would be missed
  double growing = 0.0;
  for (double theta = kStep; theta <= kWidest; theta += kStep) {
    if (slope(theta) > 0.0) {
      growing = theta;
      continue;
    }
    fold_ = theta;
    while (true) {  // halve until the two are neighbours: the slope at `growing` is still positive
      const double middle = 0.5 * (growing + fold_);
      if (middle <= growing || middle >= fold_) break;
      (slope(middle) > 0.0 ? growing : fold_) = middle;
    }
    break;
  }
  cutOff(fold_ < kWidest ? growing : kWidest);
}

void EquidistantLens::cutOff(double angle) {
  reach_ = std::min(reach_, angle);
  edge_radius_ = polynomial(reach_);
  edge_slope_ = slope(reach_);
}

double EquidistantLens::polynomial(double theta) const {
  const double t2 = theta * theta;
  return theta * (1.0 + t2 * (k_[0] + t2 * (k_[1] + t2 * (k_[2] + t2 * k_[3]))));
}

double EquidistantLens::slope(double theta) const {
  const double t2 = theta * theta;
  return 1.0 + t2 * (3.0 * k_[0] + t2 * (5.0 * k_[1] + t2 * (7.0 * k_[2] + t2 * 9.0 * k_[3])));
}

double EquidistantLens::radius(double theta) const {
  return theta <= reach_ ? polynomial(theta) : edge_radius_ + edge_slope_ * (theta - reach_);
}

/** Newton's method kept inside a shrinking bracket. */
double EquidistantLens::angle(double r) const {
  if (r <= 0.0) return 0.0;
  if (r >= edge_radius_) return std::min(M_PI, reach_ + (r - edge_radius_) / edge_slope_);
  double low = 0.0, high = reach_, theta = std::min(r, 0.5 * reach_);
  for (int i = 0; i < 200; ++i) {
    const double error = polynomial(theta) - r;
    (error > 0.0 ? high : low) = theta;
    double next = theta - error / slope(theta);
    if (!(next > low && next < high)) next = 0.5 * (low + high);
    if (std::abs(next - theta) <= 1e-16 * theta) break;
    theta = next;
  }
  return theta;
}

}  // namespace aras_visual_servo_sim
