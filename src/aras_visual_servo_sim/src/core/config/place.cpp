#include "aras_visual_servo_sim/config/place.hpp"

#include <cmath>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "aras_visual_servo_sim/config/section.hpp"

namespace aras_visual_servo_sim {

void checkPlace(const std::string& what, const Pose& pose) {
  constexpr double kLeastLength = 1e-9;
  static const auto kAllowed = sectionOf("solid").properties.at("position_m")->items->range;
  if (!pose.p.allFinite() || !pose.q.coeffs().allFinite()) throw NotFiniteError(what + ": pose is not finite");
  const double length = pose.q.norm();
  if (!(length >= kLeastLength) || !std::isfinite(length)) {
    throw ParameterError(what + ": found a quaternion of the length " + std::to_string(length) +
                         ", allowed one that can be made 1");
  }
  for (const double value : pose.p) {
    if (kAllowed.contains(value)) continue;
    throw ParameterError(what + ": found a position of " + std::to_string(value) + " m, allowed " + kAllowed.text());
  }
}

}  // namespace aras_visual_servo_sim
