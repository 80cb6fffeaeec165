#pragma once

#include <cmath>

namespace aras_visual_servo_common {

/** What a function of one number is at a place. */
struct ValueAndSlope {
  double value, slope;
};

/** Where an increasing function takes a value, to rounding: Newton's method, and halving of a bracket where that
 *  leaves it or nears too slowly, so that it arrives whatever the slopes are.
 *
 *  @param function  double -> ValueAndSlope, increasing from low to high; the slope may be rough
 *  @param wanted  a value between function(low) and function(high)
 *  @param first  where to begin, from low to high */
template <class Function>
double increasingRoot(const Function& function, double wanted, double low, double high, double first) {
  double x = first, step = high - low, step_before = step;
  constexpr int kMost = 200;  // five are usual; halving alone needs some sixty
  for (int i = 0; i < kMost; ++i) {
    const ValueAndSlope at = function(x);
    const double error = at.value - wanted;
    if (error == 0.0) break;
    (error > 0.0 ? high : low) = x;
    double next = x - error / at.slope;
    if (next == x) break;
    const bool nears = next >= low && next <= high && std::abs(next - x) <= 0.5 * std::abs(step_before);
    if (!nears) next = 0.5 * (low + high);
    if (next == x) break;
    step_before = step;
    step = next - x;
    x = next;
  }
  return x;
}

}  // namespace aras_visual_servo_common
