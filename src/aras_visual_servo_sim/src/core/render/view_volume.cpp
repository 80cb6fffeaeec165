#include "view_volume.hpp"

#include <algorithm>
#include <cmath>

namespace aras_visual_servo_sim {

ViewVolume::ViewVolume(const CameraModel& camera) {
  planes_.push_back({Eigen::Vector3d::UnitZ(), camera.nearM()});
  const auto add = [this](const Eigen::Vector3d& normal) { planes_.push_back({normal.normalized(), 0.0}); };
  if (camera.lens() == CameraModel::Lens::kNone) {
    const double margin = 1.0;  // [px] beyond the outer pixels' edges
    const double x_min = (-0.5 - margin - camera.cx()) / camera.fx();
    const double x_max = (camera.width() - 0.5 + margin - camera.cx()) / camera.fx();
    const double y_min = (-0.5 - margin - camera.cy()) / camera.fy();
    const double y_max = (camera.height() - 0.5 + margin - camera.cy()) / camera.fy();
    add({1.0, 0.0, -x_min});
    add({-1.0, 0.0, x_max});
    add({0.0, 1.0, -y_min});
    add({0.0, -1.0, y_max});
    return;
  }
  // Through a lens straight lines bend, so the border is no pyramid: take a cone about the image's largest radius as a
  // polygon of 32 sides, whose corners are 0.5 % farther out; CameraModel saw to it that the lens reaches 1 % farther.
  constexpr int kSides = 32;
  const double radius = 1.002 * camera.imageRadius();
  for (int i = 0; i < kSides; ++i) {
    const double angle = 2.0 * M_PI * i / kSides;
    add({-std::cos(angle), -std::sin(angle), radius});
  }
}

bool ViewVolume::excludes(const Eigen::Vector3d& center_C, double radius) const {
  return std::any_of(planes_.begin(), planes_.end(),
                     [&](const Plane& plane) { return plane.normal.dot(center_C) < plane.offset - radius; });
}

bool ViewVolume::contains(const Eigen::Vector3d& center_C, double radius) const {
  return std::all_of(planes_.begin(), planes_.end(),
                     [&](const Plane& plane) { return plane.normal.dot(center_C) >= plane.offset + radius; });
}

bool ViewVolume::excludes(const Eigen::Vector3d* points_C, std::size_t count) const {
  return std::any_of(planes_.begin(), planes_.end(), [&](const Plane& plane) {
    return std::all_of(points_C, points_C + count,
                       [&](const Eigen::Vector3d& point) { return plane.normal.dot(point) < plane.offset; });
  });
}

void ViewVolume::clip(std::vector<Eigen::Vector3d>& polygon_C) const {
  for (const Plane& plane : planes_) {
    if (polygon_C.empty()) return;
    scratch_.clear();
    Eigen::Vector3d before = polygon_C.back();
    double before_side = plane.normal.dot(before) - plane.offset;
    for (const Eigen::Vector3d& point : polygon_C) {
      const double side = plane.normal.dot(point) - plane.offset;
      if ((side >= 0.0) != (before_side >= 0.0)) {
        // Always from the inner to the outer end, so that triangles sharing the edge get the same point.
        const double inner = std::max(side, before_side), outer = std::min(side, before_side);
        const Eigen::Vector3d& a = side >= 0.0 ? point : before;
        const Eigen::Vector3d& b = side >= 0.0 ? before : point;
        scratch_.push_back(a + inner / (inner - outer) * (b - a));
      }
      if (side >= 0.0) scratch_.push_back(point);
      before = point;
      before_side = side;
    }
    polygon_C.swap(scratch_);
  }
}

}  // namespace aras_visual_servo_sim
