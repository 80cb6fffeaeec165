#include "picture_taps.hpp"

#include <algorithm>
#include <cmath>

#include "solid_shader.hpp"

namespace aras_visual_servo_sim {
namespace {

constexpr int kMostTaps = 16;
constexpr int kCurvedTaps = 4;  // of what lies in no plane: no bound is known, and little of it is seen from the side

/** Least power of two that is enough, so that there are few shaders. @param length  of a strip over its width */
int tapsFor(double length) {
  constexpr double kMuch = 1.5;  // below, one tap is sharp enough
  if (length <= kMuch) return 1;
  int taps = 2;
  while (taps < kMostTaps && taps * ShaderTraits::kTapLength < length) taps *= 2;
  return taps;
}

/** Of all strips in some pixels the length over the width, at most. @param n_F  the plane's normal */
double lengthIn(const PixelBox& where, const Eigen::Vector3d& n_F, double stretch, const PinholeView& view) {
  double least = 1.0, most = -1.0, longest = 0.0;
  for (int k = 0; k < 4; ++k) {
    const Eigen::Vector3d ray = view.rayThroughCorner(where, k);
    const double slope = n_F.dot(ray);  // linear in the pixels: the corners bound it
    least = std::min(least, slope);
    most = std::max(most, slope);
    longest = std::max(longest, ray.squaredNorm());
  }
  // Of a square pixel a ray of length l sees a strip l / cos long where it is 1 wide, cos being slope / l.
  const double slope = std::max({least, -most, 1e-6});
  return stretch * (std::max(view.fx, view.fy) / std::min(view.fx, view.fy)) * longest / slope;
}

}  // namespace

std::vector<TapRows> tapRowsOf(const MeshPart& part, const Eigen::Matrix4d& X_CS, const PinholeView& view,
                               const PixelBox& where, bool split) {
  constexpr int kRows = 16;
  if (!part.picture) return {{where, 1}};
  if (part.normal.isZero()) return {{where, kCurvedTaps}};
  const Eigen::Vector3d n_F = view.R_FC * (X_CS.topLeftCorner<3, 3>() * part.normal.cast<double>()).normalized();
  std::vector<TapRows> all;
  for (int top = where.v0; top < where.v1; top += split ? kRows : where.v1 - where.v0) {
    PixelBox rows = where;
    rows.v0 = top;
    if (split) rows.v1 = std::min(top + kRows, where.v1);
    const int taps = tapsFor(lengthIn(rows, n_F, part.stretch, view));
    if (!all.empty() && all.back().taps == taps) {
      all.back().where.v1 = rows.v1;
    } else {
      all.push_back({rows, taps});
    }
  }
  return all;
}

}  // namespace aras_visual_servo_sim
