#include "backdrop.hpp"

#include <algorithm>
#include <array>
#include <vector>

namespace aras_visual_servo_sim {
namespace {

constexpr std::size_t kFewTriangles = 24;
constexpr double kRounding = 1e-5;  // of a length: meshes have single precision

using Corners = std::array<Eigen::Vector3d, 3>;

Corners cornersOf(const TriangleMesh& mesh, std::size_t t) {
  Corners corners;
  for (int k = 0; k < 3; ++k) corners[k] = mesh.points[mesh.triangles[t][k]].cast<double>();
  return corners;
}

Eigen::Vector3d normalOf(const Corners& p) { return (p[1] - p[0]).cross(p[2] - p[0]).normalized(); }

/** All triangles of a mesh, in the frame of a pinhole. */
std::vector<Corners> placed(const TriangleMesh& mesh, const Eigen::Matrix4d& X_CS, const PinholeView& view) {
  const Eigen::Matrix<double, 3, 4> X_FS = view.R_FC * X_CS.topRows<3>();
  std::vector<Corners> all;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    all.push_back(cornersOf(mesh, t));
    for (Eigen::Vector3d& p : all.back()) p = X_FS * p.homogeneous();
  }
  return all;
}

/** Whether a face goes on beyond edge k of triangle t, so that a picture does not show this edge. */
bool goesOn(const TriangleMesh& mesh, std::size_t t, int k) {
  const std::uint32_t next = mesh.neighbours[t][k];
  if (next == TriangleMesh::kNone) return false;
  if (!mesh.picture_of.empty() && mesh.picture_of[t] != mesh.picture_of[next]) return false;
  return (normalOf(cornersOf(mesh, t)) - normalOf(cornersOf(mesh, next))).norm() < kRounding;
}

/** Adds the pixels along segments, which are given in the frame of a pinhole. */
class Edges {
 public:
  Edges(const PinholeView& view, double near_m, double far_m, PixelParts& parts)
      : view_(view), near_m_(near_m), far_m_(far_m), parts_(parts) {}

  void add(Eigen::Vector3d a, Eigen::Vector3d b) {
    const auto [left, right, top, bottom] = view_.border(kRim);
    const auto within = [&](double x, double y, double z, double distance) {
      const Eigen::RowVector3d n(x, y, z);
      return cut(a, b, double(n * a) + distance, double(n * b) + distance);
    };
    constexpr double kBefore = 1.0 - 1e-9;  // what was cut there is not taken to be before it
    if (within(0, 0, 1, -kBefore * near_m_) && within(0, 0, -1, (2.0 - kBefore) * far_m_) && within(1, 0, -left, 0) &&
        within(-1, 0, right, 0) && within(0, 1, -top, 0) && within(0, -1, bottom, 0)) {
      addSeen(pixelOf(a), pixelOf(b));
    }
  }

 private:
  static constexpr double kRim = 2.0;  // [px] for rounding and for samples beside the pixel's centre

  /** Cuts off what has a negative value; the value is linear along the segment. @return whether some is left */
  static bool cut(Eigen::Vector3d& a, Eigen::Vector3d& b, double at_a, double at_b) {
    if (at_a < 0.0 && at_b < 0.0) return false;
    const Eigen::Vector3d between = a + at_a / (at_a - at_b) * (b - a);  // of no use where it is not between
    if (at_a < 0.0) a = between;
    if (at_b < 0.0) b = between;
    return true;
  }

  Eigen::Vector2d pixelOf(const Eigen::Vector3d& p) const {
    return {view_.fx * p.x() / p.z() + view_.cx, view_.fy * p.y() / p.z() + view_.cy};
  }

  /** In pieces, for the box about a slanted line is large. */
  void addSeen(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
    constexpr double kPiece = 16.0;  // [px]
    if (!a.allFinite() || !b.allFinite()) return parts_.add({0, 0, view_.width, view_.height});
    const int pieces = 1 + static_cast<int>((b - a).cwiseAbs().maxCoeff() / kPiece);
    for (int k = 0; k < pieces; ++k) {
      const Eigen::Vector2d from = a + (b - a) * k / pieces, to = a + (b - a) * (k + 1) / pieces;
      parts_.add(pixelsAbout(from.cwiseMin(to).array(), from.cwiseMax(to).array(), view_));
    }
  }

  const PinholeView& view_;
  double near_m_, far_m_;
  PixelParts& parts_;
};

}  // namespace

bool canBeBackdrop(const TriangleMesh& mesh) {
  if (mesh.round || mesh.triangles.size() > kFewTriangles) return false;
  if (mesh.neighbours.size() != mesh.triangles.size()) return false;  // finish() was not called
  const double slack = kRounding * (mesh.box_max - mesh.box_min).cast<double>().norm();
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Corners corners = cornersOf(mesh, t);
    const Eigen::Vector3d n = normalOf(corners);
    const auto beyond = [&](const Eigen::Vector3f& p) { return n.dot(p.cast<double>() - corners[0]) > slack; };
    if (std::any_of(mesh.points.begin(), mesh.points.end(), beyond)) return false;
  }
  return true;
}

void addEdges(const TriangleMesh& mesh, const Eigen::Matrix4d& X_CS, const PinholeView& view, double near_m,
              double far_m, PixelParts& parts) {
  Edges edges(view, near_m, far_m, parts);
  const std::vector<Corners> triangles = placed(mesh, X_CS, view);
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const Corners& corners = triangles[t];
    for (const double depth : {near_m, far_m}) {
      std::vector<Eigen::Vector3d> cuts;
      for (int k = 0; k < 3; ++k) {
        const Eigen::Vector3d &a = corners[k], &b = corners[(k + 1) % 3];
        if ((a.z() < depth) != (b.z() < depth)) cuts.push_back(a + (depth - a.z()) / (b.z() - a.z()) * (b - a));
      }
      if (cuts.size() == 2) edges.add(cuts[0], cuts[1]);
    }
    for (int k = 0; k < 3; ++k) {
      if (!goesOn(mesh, t, k)) edges.add(corners[k], corners[(k + 1) % 3]);
    }
  }
}

bool fills(const TriangleMesh& mesh, const Eigen::Matrix4d& X_CS, const PinholeView& view, double near_m, double far_m,
           const PixelBox& part) {
  // What is seen of one face is convex: it fills the part if it is seen in the four corners.
  constexpr double kRim = 2.0;  // [px]
  const std::vector<Corners> triangles = placed(mesh, X_CS, view);
  Eigen::Vector3d face = Eigen::Vector3d::Zero();
  for (int corner = 0; corner < 4; ++corner) {
    const Eigen::Vector3d ray = view.rayThroughCorner(part, corner, kRim);
    const bool seen = std::any_of(triangles.begin(), triangles.end(), [&](const Corners& p) {
      for (int k = 0; k < 3; ++k) {
        if (ray.dot(p[k].cross(p[(k + 1) % 3])) > 0.0) return false;  // beside it, or it looks away
      }
      const Eigen::Vector3d n = normalOf(p);
      if (corner == 0) face = n;
      const double depth = n.dot(p[0]) / n.dot(ray);
      return depth > near_m && depth < far_m && (n - face).norm() < kRounding;
    });
    if (!seen) return false;
  }
  return true;
}

}  // namespace aras_visual_servo_sim
