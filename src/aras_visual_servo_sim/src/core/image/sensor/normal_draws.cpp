#include "normal_draws.hpp"

#include <algorithm>
#include <cmath>

namespace aras_visual_servo_sim {

namespace {

constexpr int kQuantiles = 1 << 16;

}  // namespace

const std::vector<float>& normalQuantiles() {
  static const std::vector<float> table = [] {
    std::vector<float> quantiles(kQuantiles);
    double z = -5.0;
    for (int k = 0; k < kQuantiles / 2; ++k) {
      const double p = (k + 0.5) / kQuantiles;
      for (int i = 0; i < 20; ++i) {  // Newton from the previous quantile, below the root of a convex function
        const double density = std::exp(-0.5 * z * z) / std::sqrt(2.0 * M_PI);
        const double step = (p - 0.5 * std::erfc(-z / std::sqrt(2.0))) / density;
        z += std::clamp(step, -0.25, 0.25);
        if (std::abs(step) < 1e-12) break;
      }
      quantiles[k] = static_cast<float>(z);
      quantiles[kQuantiles - 1 - k] = static_cast<float>(-z);
    }
    return quantiles;
  }();
  return table;
}

}  // namespace aras_visual_servo_sim
