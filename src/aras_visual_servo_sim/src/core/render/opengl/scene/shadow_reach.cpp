#include "shadow_reach.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace aras_visual_servo_sim {
namespace {

constexpr int kCorners = 8;

/** Corner of a mesh's box: bits 0, 1, 2 of k choose the side in x, y, z. */
Eigen::Vector3d cornerOf(const TriangleMesh& mesh, int k) {
  return Eigen::Vector3f(k & 1 ? mesh.box_max.x() : mesh.box_min.x(), k & 2 ? mesh.box_max.y() : mesh.box_min.y(),
                         k & 4 ? mesh.box_max.z() : mesh.box_min.z())
      .cast<double>();
}

/** Grows with each point that it sees. */
class Outline {
 public:
  Outline(const PinholeView& view, double near_m) : view_(view), near_m_(near_m) {}

  void see(const Eigen::Vector3d& p_C) {
    const Eigen::Vector3d p = view_.R_FC * p_C;
    if (p.z() < near_m_) {
      everywhere_ = true;
      return;
    }
    const Eigen::Array2d at(view_.fx * p.x() / p.z() + view_.cx, view_.fy * p.y() / p.z() + view_.cy);
    low_ = low_.min(at);
    high_ = high_.max(at);
  }

  PixelPart part() const {
    if (everywhere_) return {0, 0, view_.width, view_.height};
    if (!(low_.x() <= high_.x())) return {};
    constexpr double kRim = 2.0;  // [px] for rounding and for samples beside the pixel's centre
    const auto within = [](double value, int size) { return static_cast<int>(std::clamp(value, 0.0, double(size))); };
    return {within(std::floor(low_.x() - kRim), view_.width), within(std::floor(low_.y() - kRim), view_.height),
            within(std::ceil(high_.x() + kRim) + 1.0, view_.width),
            within(std::ceil(high_.y() + kRim) + 1.0, view_.height)};
  }

 private:
  const PinholeView& view_;
  double near_m_;
  Eigen::Array2d low_ = Eigen::Array2d::Constant(1e9), high_ = -low_;
  bool everywhere_ = false;
};

/** A point in C and where it is on the map. */
struct Corner {
  Eigen::Vector3d p_C;
  Eigen::Vector3d on_map;
};

/** What of a polygon lies where side * on_map[axis] <= side * limit. */
std::vector<Corner> clipped(const std::vector<Corner>& polygon, int axis, double side, double limit) {
  std::vector<Corner> left;
  const auto beyond = [&](const Corner& each) { return side * (each.on_map[axis] - limit); };
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Corner &here = polygon[k], &next = polygon[(k + 1) % polygon.size()];
    const double a = beyond(here), b = beyond(next);
    if (a <= 0.0) left.push_back(here);
    if ((a < 0.0 && b > 0.0) || (a > 0.0 && b < 0.0)) {
      const double way = a / (a - b);
      left.push_back({here.p_C + way * (next.p_C - here.p_C), here.on_map + way * (next.on_map - here.on_map)});
    }
  }
  return left;
}

}  // namespace

PixelPart PixelPart::with(const PixelPart& other) const {
  if (empty()) return other;
  if (other.empty()) return *this;
  return {std::min(left, other.left), std::min(top, other.top), std::max(right, other.right),
          std::max(bottom, other.bottom)};
}

PixelPart PixelPart::within(const PixelPart& other) const {
  PixelPart both;
  both.left = std::clamp(left, other.left, other.right);
  both.right = std::clamp(right, both.left, other.right);
  both.top = std::clamp(top, other.top, other.bottom);
  both.bottom = std::clamp(bottom, both.top, other.bottom);
  return both;
}

PixelPart coveredPart(const TriangleMesh& mesh, const Eigen::Matrix4d& X_CS, const PinholeView& view, double near_m) {
  Outline outline(view, near_m);
  for (int k = 0; k < kCorners; ++k) outline.see((X_CS * cornerOf(mesh, k).homogeneous()).head<3>());
  return outline.part();
}

PixelPart shadowedPart(const TriangleMesh& mesh, const Eigen::Matrix4d& X_CS, const ShadowMaps::Map& map,
                       const Eigen::Matrix4d& of_camera, const PinholeView& view, double near_m) {
  std::array<Corner, kCorners> corners;
  bool behind = false;  // farther from the light than the first thing that casts a shadow
  for (int k = 0; k < kCorners; ++k) {
    const Eigen::Vector3d p_C = (X_CS * cornerOf(mesh, k).homogeneous()).head<3>();
    corners[k] = {p_C, (of_camera * p_C.homogeneous()).head<3>()};
    behind = behind || corners[k].on_map.z() >= 0.0;
  }
  if (!behind) return {};
  // Where the box meets the pillar above the map, the outermost points lie on the faces of the box.
  constexpr int kFaces[6][4] = {{0, 1, 3, 2}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 3, 7, 5}};
  constexpr double kTaps = 3.0;  // [texels] that a shadow reads beside its place
  const double rim_s = kTaps / map.width, rim_t = kTaps / map.height;
  Outline outline(view, near_m);
  for (const auto& face : kFaces) {
    std::vector<Corner> polygon;
    for (const int k : face) polygon.push_back(corners[k]);
    polygon = clipped(clipped(polygon, 0, 1.0, 1.0 + rim_s), 0, -1.0, -rim_s);
    polygon = clipped(clipped(polygon, 1, 1.0, 1.0 + rim_t), 1, -1.0, -rim_t);
    for (const Corner& corner : polygon) outline.see(corner.p_C);
  }
  return outline.part();
}

}  // namespace aras_visual_servo_sim
