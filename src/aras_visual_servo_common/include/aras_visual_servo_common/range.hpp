#pragma once

#include <limits>
#include <string>

namespace aras_visual_servo_common {

/** Interval a number must lie in; each end belongs to it unless it is excluded. NaN and infinities never do. */
struct Range {
  double min = -std::numeric_limits<double>::max();
  double max = std::numeric_limits<double>::max();
  bool min_excluded = false;
  bool max_excluded = false;

  bool contains(double value) const;

  /** In words, e.g. "> 0 and <= 255", or "finite" when there are no ends. */
  std::string text() const;
};

}  // namespace aras_visual_servo_common
