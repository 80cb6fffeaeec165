#include "image/depth_reader.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace aras_visual_servo_camera {
namespace {

constexpr double kHole = std::numeric_limits<double>::quiet_NaN();
// Least determinant of the scatter of the pixels, over the square of its trace: below it they lie on a line. A row of
// three pixels and one beside it have 0.15.
constexpr double kFlat = 1e-3;
constexpr int kLeastPixels = 3;

/** Sums over pixels of 1, x, y, xx, xy, yy, z, xz, yz, with x, y from the point and z = 1/Z. */
class InversePlane {
 public:
  void add(double x, double y, double z) {
    const std::array<double, 9> terms{1.0, x, y, x * x, x * y, y * y, z, x * z, y * z};
    for (std::size_t k = 0; k < terms.size(); ++k) sums_[k] += terms[k];
  }

  double count() const { return sums_[0]; }

  /** z at x = y = 0 by least squares; NaN where the pixels lie on a line. */
  double atPoint() const {
    const auto& [n, x, y, xx, xy, yy, z, xz, yz] = sums_;
    const double mx = x / n, my = y / n, mz = z / n;
    const double cxx = xx / n - mx * mx, cxy = xy / n - mx * my, cyy = yy / n - my * my;
    const double czx = xz / n - mx * mz, czy = yz / n - my * mz;
    const double determinant = cxx * cyy - cxy * cxy, trace = cxx + cyy;
    if (!(determinant > kFlat * trace * trace)) return kHole;
    const double slope_x = (cyy * czx - cxy * czy) / determinant, slope_y = (cxx * czy - cxy * czx) / determinant;
    return mz - slope_x * mx - slope_y * my;
  }

 private:
  std::array<double, 9> sums_{};
};

}  // namespace

std::string DepthReader::fault(const DepthView* depth) const {
  if (!depth) return "no depth image came with the image";
  if (depth->width_px == map_.width() && depth->height_px == map_.height()) return "";
  return "the depth image is " + std::to_string(depth->width_px) + " x " + std::to_string(depth->height_px) +
         ", allowed " + std::to_string(map_.width()) + " x " + std::to_string(map_.height()) +
         ", the size in camera_info";
}

double DepthReader::at(const DepthView& depth, double x, double y, const ObjectMask* among) const {
  const int reach = config_.window_px / 2;
  const double z = within(reach, depth, x, y, among);
  return std::isnan(z) && among ? within(2 * reach, depth, x, y, among) : z;
}

double DepthReader::within(int reach, const DepthView& depth, double x, double y, const ObjectMask* among) const {
  const auto [u_px, v_px] = map_.intrinsics().project(x, y);
  if (!(std::abs(u_px) < 1e6 && std::abs(v_px) < 1e6)) return kHole;
  const int u = static_cast<int>(std::lround(u_px)), v = static_cast<int>(std::lround(v_px));
  const bool inside = u >= 0 && v >= 0 && u < map_.width() && v < map_.height();
  if (reach == 0) return inside ? depth.at(u, v) : kHole;
  const double below = !among && inside ? depth.at(u, v) : kHole;
  if (!among && std::isnan(below)) return kHole;
  InversePlane plane;
  const auto look = [&](int from, int to, int row) {
    for (int k = std::max(from, u - reach); k < std::min(to, u + reach + 1); ++k) {
      const double Z = depth.at(k, row);
      if (std::isnan(Z) || (!among && std::abs(Z - below) > config_.max_step * below)) continue;
      const PixelMap::Pixel ray = map_.at(k, row);
      if (ray.area != 0.0) plane.add(ray.x - x, ray.y - y, 1.0 / Z);
    }
  };
  const int first = std::max(0, v - reach), last = std::min(map_.height() - 1, v + reach);
  if (among) {
    auto span = std::lower_bound(among->spans.begin(), among->spans.end(), first,
                                 [](const Span& a, int row) { return a.v < row; });
    for (; span != among->spans.end() && span->v <= last; ++span) look(span->u_begin, span->u_end, span->v);
  } else {
    for (int row = first; row <= last; ++row) look(std::max(0, u - reach), map_.width(), row);
  }
  if (plane.count() < kLeastPixels) return kHole;
  const double over_Z = plane.atPoint();
  return over_Z > 0.0 ? 1.0 / over_Z : kHole;
}

}  // namespace aras_visual_servo_camera
