#include "view_volume.hpp"

#include <algorithm>
#include <cmath>

namespace aras_visual_servo_sim {

void ViewCell::add(const Eigen::Vector3d& normal_F, double offset) {
  const Eigen::Vector3d normal = normal_F.normalized();
  planes_[count_++] = {ahead_ ? normal : Eigen::Vector3d(R_FC_.transpose() * normal), offset};
}

ViewVolume::ViewVolume(const CameraModel& camera) {
  switch (camera.lens()) {
    case CameraModel::Lens::kNone:
      addPinhole(camera);
      break;
    case CameraModel::Lens::kEquidistant:
      addCube(camera);
      break;
    default:
      addCone(camera);
  }
}

void ViewVolume::addPinhole(const CameraModel& camera) {
  ViewCell& cell = addCell();
  cell.add(Eigen::Vector3d::UnitZ(), camera.nearM());
  const double margin = 1.0;  // [px] beyond the outer pixels' edges
  const double x_min = (-0.5 - margin - camera.cx()) / camera.fx();
  const double x_max = (camera.width() - 0.5 + margin - camera.cx()) / camera.fx();
  const double y_min = (-0.5 - margin - camera.cy()) / camera.fy();
  const double y_max = (camera.height() - 0.5 + margin - camera.cy()) / camera.fy();
  cell.add({1.0, 0.0, -x_min});
  cell.add({-1.0, 0.0, x_max});
  cell.add({0.0, 1.0, -y_min});
  cell.add({0.0, -1.0, y_max});
}

/** Through a polynomial lens straight lines bend, so the border is no pyramid: take a cone about the image's largest
 *  radius as a polygon of 32 sides, whose corners are 0.5 % farther out; CameraModel saw to it that the lens reaches
 *  1 % farther. */
void ViewVolume::addCone(const CameraModel& camera) {
  ViewCell& cell = addCell();
  cell.add(Eigen::Vector3d::UnitZ(), camera.nearM());
  constexpr int kSides = 32;
  const double radius = 1.002 * camera.imageRadius();
  for (int i = 0; i < kSides; ++i) {
    const double angle = 2.0 * M_PI * i / kSides;
    cell.add({-std::cos(angle), -std::sin(angle), radius});
  }
}

void ViewVolume::addCube(const CameraModel& camera) {
  const double angle = camera.imageAngle() + 0.01;  // [rad] of margin
  const double slope = angle < 0.25 * M_PI ? std::tan(angle) : 1.0;
  const auto addFace = [&](const Eigen::Matrix3d& R_FC) -> ViewCell& {
    ViewCell& cell = addCell();
    cell.ahead_ = false;
    cell.R_FC_ = R_FC;
    cell.add(Eigen::Vector3d::UnitZ(), camera.nearM());
    for (const double side : {1.0, -1.0}) {
      cell.add({side, 0.0, slope});
      cell.add({0.0, side, slope});
    }
    return cell;
  };
  addFace(Eigen::Matrix3d::Identity());
  if (angle < 0.25 * M_PI) return;
  const Eigen::Vector3d forward = Eigen::Vector3d::UnitZ();
  for (const Eigen::Vector3d& axis :
       {Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(-1, 0, 0), Eigen::Vector3d(0, 1, 0), Eigen::Vector3d(0, -1, 0)}) {
    Eigen::Matrix3d R_FC;  // the optical axis is y of F
    R_FC << forward.cross(axis).transpose(), forward.transpose(), axis.transpose();
    ViewCell& cell = addFace(R_FC);
    // Rays within the angle have Z >= cot(angle) sqrt(X^2 + Y^2) in C. In F that is, for one axis, at least
    // cot(angle) times the depth, or sqrt(2) times as much where it is negative.
    const double cotangent = 1.0 / std::tan(angle);
    cell.add({0.0, 1.0, -cotangent * (cotangent < 0.0 ? std::sqrt(2.0) : 1.0)});
  }
}

bool ViewCell::excludes(const Eigen::Vector3d& center_C, double radius) const {
  return std::any_of(begin(), end(),
                     [&](const Plane& plane) { return plane.normal.dot(center_C) < plane.offset - radius; });
}

bool ViewCell::contains(const Eigen::Vector3d& center_C, double radius) const {
  return std::all_of(begin(), end(),
                     [&](const Plane& plane) { return plane.normal.dot(center_C) >= plane.offset + radius; });
}

bool ViewCell::excludes(const Eigen::Vector3d* points_C, std::size_t count) const {
  return std::any_of(begin(), end(), [&](const Plane& plane) {
    return std::all_of(points_C, points_C + count,
                       [&](const Eigen::Vector3d& point) { return plane.normal.dot(point) < plane.offset; });
  });
}

void ViewCell::clip(std::vector<Eigen::Vector3d>& polygon_C, std::vector<char>* seams) const {
  thread_local std::vector<Eigen::Vector3d> kept_of_thread;  // their memory is used again
  thread_local std::vector<char> seams_of_thread;
  std::vector<Eigen::Vector3d>& kept = kept_of_thread;  // asking for what is a thread's takes a call each time
  std::vector<char>& seams_kept = seams_of_thread;
  for (const Plane& plane : *this) {
    if (std::all_of(polygon_C.begin(), polygon_C.end(),
                    [&plane](const Eigen::Vector3d& point) { return plane.normal.dot(point) - plane.offset >= 0.0; })) {
      continue;
    }
    kept.clear();
    seams_kept.clear();
    const auto keep = [&](const Eigen::Vector3d& point, bool seam) {
      kept.push_back(point);
      seams_kept.push_back(seam ? 1 : 0);
    };
    const auto seam = [&](std::size_t i) { return seams && (*seams)[i] != 0; };
    double before_side = plane.normal.dot(polygon_C.back()) - plane.offset;
    for (std::size_t i = 0, j = polygon_C.size() - 1; i < polygon_C.size(); j = i++) {
      const Eigen::Vector3d &point = polygon_C[i], &before = polygon_C[j];
      const double side = plane.normal.dot(point) - plane.offset;
      if ((side >= 0.0) != (before_side >= 0.0)) {
        // Always from the inner to the outer end, so that triangles sharing the edge get the same point.
        const double inner = std::max(side, before_side), outer = std::min(side, before_side);
        const Eigen::Vector3d& a = side >= 0.0 ? point : before;
        const Eigen::Vector3d& b = side >= 0.0 ? before : point;
        keep(a + inner / (inner - outer) * (b - a), side >= 0.0 && seam(j));
      }
      if (side >= 0.0) keep(point, seam(i));
      before_side = side;
    }
    polygon_C.swap(kept);
    if (seams) seams->swap(seams_kept);
  }
}

}  // namespace aras_visual_servo_sim
