#include "moments/kernel_projection.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace aras_visual_servo_camera {

KernelProjection::KernelProjection(const PixelMap& map, double p, double q) : map_(map), p_(p), q_(q) {
  // One pixel outside the rays of the image's border, whatever the lens.
  for (int v = 0; v < map.height(); ++v) {
    for (int u = 0; u < map.width(); ++u) {
      const PixelMap::Pixel pixel = map.at(u, v);
      x0_ = std::min(x0_, pixel.x - 1.0 / map.intrinsics().fx());
      y0_ = std::min(y0_, pixel.y - 1.0 / map.intrinsics().fy());
    }
  }
  powers_.reserve(static_cast<std::size_t>(map.width()) * map.height());
  for (int v = 0; v < map.height(); ++v) {
    for (int u = 0; u < map.width(); ++u) {
      const PixelMap::Pixel pixel = map.at(u, v);
      powers_.push_back({std::pow(pixel.x - x0_, -p - 1.0), std::pow(pixel.y - y0_, -q - 1.0)});
    }
  }
}

void KernelProjection::write(const ObjectMask& mask, MomentFeatures* features) const {
  features->kernel_x.clear();
  features->kernel_y.clear();
  if (!features->target_visible) return;
  std::array<double, 6> sums_x{}, sums_y{};
  const auto add = [&](int u, int v, double weight) {
    const PixelMap::Pixel pixel = map_.at(u, v);
    const Powers& powers = powers_[static_cast<std::size_t>(v) * map_.width() + u];
    double a = weight * pixel.area * powers.x, b = weight * pixel.area * powers.y;
    for (int k = 2; k >= 0; --k, a *= pixel.x - x0_, b *= pixel.y - y0_) {
      sums_x[2 * k] += a;
      sums_x[2 * k + 1] += a * pixel.y;
      sums_y[2 * k] += b;
      sums_y[2 * k + 1] += b * pixel.x;
    }
  };
  for (const Span& s : mask.spans)
    for (int u = s.u_begin; u < s.u_end; ++u) add(u, s.v, 1.0);
  for (const EdgePixel& e : mask.edge) add(e.u, e.v, e.weight);
  features->kernel_x = {p_, x0_};
  features->kernel_y = {q_, y0_};
  features->kernel_x.insert(features->kernel_x.end(), sums_x.begin(), sums_x.end());
  features->kernel_y.insert(features->kernel_y.end(), sums_y.begin(), sums_y.end());
}

}  // namespace aras_visual_servo_camera
