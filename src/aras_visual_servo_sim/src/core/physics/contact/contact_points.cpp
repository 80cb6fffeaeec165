#include "contact_points.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cstddef>

namespace aras_visual_servo_sim {

using Eigen::Vector2d;
using Eigen::Vector3d;

namespace {

constexpr std::size_t kPointsOfAFace = 4;
constexpr double kOnAnEdge = 1e-6;  // [m] from the line between its neighbours, a point is no corner

/** A point in the plane across a normal, and where it stands in the list. */
struct Flat {
  Vector2d p;
  std::size_t index;
};

/** Whether b is a corner to the left between a and c. */
bool isCorner(const Vector2d& a, const Vector2d& b, const Vector2d& c) {
  const Vector2d along = c - a;
  const Vector2d to = b - a;
  const double turn = to.x() * along.y() - to.y() * along.x();
  return turn > kOnAnEdge * std::max(along.norm(), kOnAnEdge);
}

/** Half of the outline of points sorted along x, from the first to the last: those on the right of the line on. */
std::vector<Flat> halfOutline(const std::vector<Flat>& sorted) {
  std::vector<Flat> half;
  for (const Flat& next : sorted) {
    while (half.size() >= 2 && !isCorner(half[half.size() - 2].p, half.back().p, next.p)) half.pop_back();
    if (half.size() == 1 && (next.p - half[0].p).norm() < kOnAnEdge) continue;
    half.push_back(next);
  }
  return half;
}

}  // namespace

void keepCorners(std::vector<ContactPoint>& points, std::size_t first) {
  if (points.size() < first + 2) return;
  const Vector3d normal = points[first].normal;
  const Vector3d side = normal.unitOrthogonal();
  const Vector3d other = normal.cross(side);
  std::vector<Flat> flat;
  for (std::size_t k = first; k < points.size(); ++k) {
    flat.push_back({{side.dot(points[k].point), other.dot(points[k].point)}, k});
  }
  std::stable_sort(flat.begin(), flat.end(), [](const Flat& one, const Flat& two) {
    return one.p.x() < two.p.x() || (one.p.x() == two.p.x() && one.p.y() < two.p.y());
  });
  std::vector<Flat> outline = halfOutline(flat);
  std::reverse(flat.begin(), flat.end());
  const std::vector<Flat> back = halfOutline(flat);
  for (const Flat& corner : back) {
    const bool known = std::any_of(outline.begin(), outline.end(),
                                   [&](const Flat& each) { return (each.p - corner.p).norm() < kOnAnEdge; });
    if (!known) outline.push_back(corner);
  }
  std::vector<ContactPoint> kept;
  for (const Flat& corner : outline) kept.push_back(points[corner.index]);
  points.resize(first);
  points.insert(points.end(), kept.begin(), kept.end());
}

void thinOut(std::vector<ContactPoint>& points, std::size_t first) {
  if (points.size() - first <= 2 * kPointsOfAFace) return;
  const auto begin = points.begin() + static_cast<std::ptrdiff_t>(first);
  std::iter_swap(begin, std::max_element(begin, points.end(), [](const auto& one, const auto& other) {
                   return one.depth_m < other.depth_m;
                 }));
  for (std::size_t kept = 1; kept < kPointsOfAFace; ++kept) {
    const auto distance = [&](const ContactPoint& point) {
      double nearest = (point.point - begin->point).squaredNorm();
      for (std::size_t k = 1; k < kept; ++k) nearest = std::min(nearest, (point.point - begin[k].point).squaredNorm());
      return nearest;
    };
    const auto farthest =
        std::max_element(begin + static_cast<std::ptrdiff_t>(kept), points.end(),
                         [&](const auto& one, const auto& other) { return distance(one) < distance(other); });
    std::iter_swap(begin + static_cast<std::ptrdiff_t>(kept), farthest);
  }
  points.resize(first + kPointsOfAFace);
}

}  // namespace aras_visual_servo_sim
