#include "shadow_reach.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

namespace aras_visual_servo_sim {
namespace {

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

  PixelBox part() const {
    if (everywhere_) return {0, 0, view_.width, view_.height};
    if (!(low_.x() <= high_.x())) return {};
    return pixelsAbout(low_, high_, view_);
  }

 private:
  const PinholeView& view_;
  double near_m_;
  Eigen::Array2d low_ = Eigen::Array2d::Constant(1e9), high_ = -low_;
  bool everywhere_ = false;
};

}  // namespace

PixelBox pixelsAbout(const Eigen::Array2d& low, const Eigen::Array2d& high, const PinholeView& view) {
  constexpr double kRim = 2.0;  // [px] for rounding and for samples beside the pixel's centre
  const auto within = [](double value, int size) { return static_cast<int>(std::clamp(value, 0.0, double(size))); };
  return {within(std::floor(low.x() - kRim), view.width), within(std::floor(low.y() - kRim), view.height),
          within(std::ceil(high.x() + kRim) + 1.0, view.width), within(std::ceil(high.y() + kRim) + 1.0, view.height)};
}

void PixelParts::add(const PixelBox& added) {
  constexpr double kPartCost = 3000.0;  // [px] that take as long to shade as one more part takes to begin
  constexpr std::size_t kMost = 12;
  PixelBox part = added.within(within_);
  if (part.empty()) return;
  for (;;) {
    std::size_t best = parts_.size();
    double least = parts_.size() < kMost ? kPartCost : std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < parts_.size(); ++k) {
      const double more = part.with(parts_[k]).area() - part.area() - parts_[k].area();
      if (more >= least) continue;
      least = more;
      best = k;
    }
    if (best == parts_.size()) break;
    part = part.with(parts_[best]);  // and see whether others are close to both
    parts_.erase(parts_.begin() + static_cast<std::ptrdiff_t>(best));
  }
  parts_.push_back(part);
}

void PixelParts::join(const PixelBox& part, double saved_px) {
  PixelBox joined;
  double area = 0.0, saved = -saved_px;
  const auto meets = [&](const PixelBox& other) { return !other.within(part).empty(); };
  for (const PixelBox& other : parts_) {
    if (!meets(other)) continue;
    joined = joined.with(other);
    area += other.area();
    saved += saved_px;
  }
  if (joined.empty() || joined.area() - area > saved) return;
  parts_.erase(std::remove_if(parts_.begin(), parts_.end(), meets), parts_.end());
  parts_.push_back(joined);
}

double PixelParts::area() const {
  double sum = 0.0;
  for (const PixelBox& part : parts_) sum += part.area();
  return sum;
}

template <typename Beyond>
SeenMesh::Outlined SeenMesh::Outlined::clipped(const Beyond& beyond) const {
  Outlined left;
  for (int k = 0; k < count_; ++k) {
    const Corner &here = corners_[k], &next = corners_[(k + 1) % count_];
    const double a = beyond(here), b = beyond(next);
    if (a <= 0.0) left.add(here);
    if ((a < 0.0 && b > 0.0) || (a > 0.0 && b < 0.0)) {
      const double way = a / (a - b);
      left.add({here.p_C + way * (next.p_C - here.p_C), here.on_map + way * (next.on_map - here.on_map)});
    }
  }
  return left;
}

SeenMesh::SeenMesh(const TriangleMesh& mesh, const Eigen::Matrix4d& X_CS, const Eigen::Matrix4d& of_camera,
                   const PinholeView& view)
    : view_(view) {
  constexpr int kFaces[6][4] = {{0, 1, 3, 2}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 3, 7, 5}};
  constexpr double kRim = 1.5;  // [px] for rounding and for samples beside the pixel's centre
  const PinholeView::Border border = view.border(kRim);
  const auto side = [&](int axis, double sign, double slope) {
    const Eigen::RowVector3d n = sign * (view.R_FC.row(axis) - slope * view.R_FC.row(2));
    return [n](const Corner& corner) { return double(n * corner.p_C); };
  };
  std::array<Corner, 8> corners;
  for (int k = 0; k < 8; ++k) {
    const Eigen::Vector3d p_C = (X_CS * mesh.corner(k).homogeneous()).head<3>();
    corners[k] = {p_C, (of_camera * p_C.homogeneous()).head<3>()};
  }
  for (int face = 0; face < 6; ++face) {
    Outlined whole;
    for (const int k : kFaces[face]) whole.add(corners[k]);
    faces_[face] = whole.clipped(side(0, -1.0, border.left))
                       .clipped(side(0, 1.0, border.right))
                       .clipped(side(1, -1.0, border.top))
                       .clipped(side(1, 1.0, border.bottom));
    for (const Corner& corner : faces_[face]) box_.add(corner.on_map);
  }
  // Of the box and the pyramid that the picture shows the outermost points lie on the faces of the box, or one is the
  // tip of the pyramid.
  const Eigen::Array3d eye_S = (X_CS.inverse().topRightCorner<3, 1>()).array();
  const Eigen::Array3d low = mesh.box_min.cast<double>().array(), high = mesh.box_max.cast<double>().array();
  about_eye_ = (eye_S >= low).all() && (eye_S <= high).all();
  if (about_eye_) box_.add(of_camera.topRightCorner<3, 1>());
}

PixelBox SeenMesh::covered(double near_m) const {
  if (about_eye_) return {0, 0, view_.width, view_.height};
  constexpr double kBefore = 1.0 - 1e-9;  // of the plane: what is cut there is not taken to be before it
  Outline outline(view_, kBefore * near_m);
  const Eigen::RowVector3d axis = view_.R_FC.row(2);
  for (const Outlined& face : faces_) {
    const Outlined ahead = face.clipped([&](const Corner& corner) { return near_m - double(axis * corner.p_C); });
    for (const Corner& corner : ahead) outline.see(corner.p_C);
  }
  return outline.part();
}

PixelBox SeenMesh::shadowOf(const MapBox& caster, double near_m) const {
  // Of a face and the pillar behind a caster the outermost points are corners of what both share.
  const auto beyond = [](int axis, double sign, double limit) {
    return [axis, sign, limit](const Corner& corner) { return sign * (corner.on_map[axis] - limit); };
  };
  Outline outline(view_, near_m);
  for (const Outlined& face : faces_) {
    const Outlined shaded = face.clipped(beyond(2, -1.0, caster.low.z()))
                                .clipped(beyond(0, 1.0, caster.high.x()))
                                .clipped(beyond(0, -1.0, caster.low.x()))
                                .clipped(beyond(1, 1.0, caster.high.y()))
                                .clipped(beyond(1, -1.0, caster.low.y()));
    for (const Corner& corner : shaded) outline.see(corner.p_C);
  }
  return outline.part();
}

PixelBox coveredPart(const TriangleMesh& mesh, const Eigen::Matrix4d& X_CS, const PinholeView& view, double near_m) {
  return SeenMesh(mesh, X_CS, Eigen::Matrix4d::Identity(), view).covered(near_m);
}

}  // namespace aras_visual_servo_sim
