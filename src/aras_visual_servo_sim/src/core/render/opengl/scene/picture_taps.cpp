#include "picture_taps.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

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

/** Length over width of the strip that a pixel sees of a plane. @param n_F  the plane's normal */
double lengthAt(const Eigen::Vector3d& ray, const Eigen::Vector3d& n_F, const PinholeView& view) {
  // The point of the plane n . p = 1 on a ray r = (x, y, 1) is r / (n . r); how it moves with x and y, times (n . r)^2:
  const double slope = n_F.dot(ray);
  const Eigen::Vector3d right = (slope * Eigen::Vector3d::UnitX() - n_F.x() * ray) / view.fx;
  const Eigen::Vector3d down = (slope * Eigen::Vector3d::UnitY() - n_F.y() * ray) / view.fy;
  const double a = right.squaredNorm(), b = right.dot(down), c = down.squaredNorm();
  const double root = std::sqrt((a - c) * (a - c) + 4.0 * b * b);  // of the difference of the squared axes
  return std::sqrt((a + c + root) / std::max(a + c - root, 1e-12 * (a + c)));
}

/** Of all strips in some pixels the length over the width, about at most. @param n_F  the plane's normal */
double lengthIn(const PixelBox& where, const Eigen::Vector3d& n_F, double stretch, const PinholeView& view) {
  double longest = 0.0, least = 1.0, most = -1.0;
  for (int k = 0; k < 4; ++k) {
    const Eigen::Vector3d ray = view.rayThroughCorner(where, k);
    longest = std::max(longest, lengthAt(ray, n_F, view));
    least = std::min(least, n_F.dot(ray));
    most = std::max(most, n_F.dot(ray));
  }
  const bool has_horizon = least < 0.0 && most > 0.0;
  return has_horizon ? std::numeric_limits<double>::infinity() : stretch * longest;
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
