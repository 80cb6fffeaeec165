#include "aras_visual_servo_common/range.hpp"

#include <cmath>

#include "aras_visual_servo_common/text.hpp"

namespace aras_visual_servo_common {

bool Range::contains(double value) const {
  const bool above = min_excluded ? value > min : value >= min;
  const bool below = max_excluded ? value < max : value <= max;
  return std::isfinite(value) && above && below;
}

std::string Range::text() const {
  constexpr double kLargest = std::numeric_limits<double>::max();
  const std::string low = (min_excluded ? "> " : ">= ") + numberText(min);
  const std::string high = (max_excluded ? "< " : "<= ") + numberText(max);
  if (min > -kLargest && max < kLargest) return low + " and " + high;
  if (min > -kLargest) return low;
  if (max < kLargest) return high;
  return "finite";
}

}  // namespace aras_visual_servo_common
