#include "aras_visual_servo_sim/camera/equidistant_lens.hpp"

#include <algorithm>
#include <aras_visual_servo_common/increasing_root.hpp>
#include <cmath>

namespace aras_visual_servo_sim {

using aras_visual_servo_common::increasingRoot;
using aras_visual_servo_common::ValueAndSlope;

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

double EquidistantLens::angle(double r) const {
  if (r <= 0.0) return 0.0;
  if (r >= edge_radius_) return std::min(M_PI, reach_ + (r - edge_radius_) / edge_slope_);
  const auto drawn = [this](double theta) { return ValueAndSlope{polynomial(theta), slope(theta)}; };
  return increasingRoot(drawn, r, 0.0, reach_, std::min(r, 0.5 * reach_));
}

}  // namespace aras_visual_servo_sim
