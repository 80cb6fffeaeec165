#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "aras_visual_servo_sim/camera/camera_model.hpp"

namespace aras_visual_servo_sim {

/** Part of what a camera can see: a pyramid with its apex in the origin of the camera's frame C, cut off by the near
 *  plane across its axis.
 *
 *  Everything drawn is clipped to it, so that dividing by the depth along the axis never fails and straight lines stay
 *  straight in coordinates (x, y) = (X, Y) / Z of its own frame F, whose Z is the axis. */
class ViewCell {
 public:
  /** Half-space normal . p >= offset, |normal| = 1, in C. */
  struct Plane {
    Eigen::Vector3d normal;
    double offset;
  };

  /** Whether a ball lies wholly outside one of the planes. */
  bool excludes(const Eigen::Vector3d& center_C, double radius) const;
  /** Whether a ball lies wholly inside all of them. */
  bool contains(const Eigen::Vector3d& center_C, double radius) const;
  /** Whether all points lie outside one and the same plane. */
  bool excludes(const Eigen::Vector3d* points_C, std::size_t count) const;
  /** Cuts a polygon (Sutherland and Hodgman): what is left may be empty. Concave ones keep edges of no area.
   *  @param seams  of the edge from each corner to the next, if they are of interest: parts of an edge keep what it
   *                was, and edges along the cell's planes get 0 */
  void clip(std::vector<Eigen::Vector3d>& polygon_C, std::vector<char>* seams = nullptr) const;

  /** Through the fisheye longer edges in (x, y) are cut anyway: their middle may lie on an inflexion. */
  static constexpr double kLongest = 0.25;

  /** Depth along the axis [m]. */
  double depth(const Eigen::Vector3d& p_C) const { return ahead_ ? p_C.z() : R_FC_.row(2).dot(p_C); }
  /** (X, Y) of F. */
  Eigen::Vector2d across(const Eigen::Vector3d& p_C) const {
    return ahead_ ? p_C.head<2>() : Eigen::Vector2d(R_FC_.topRows<2>() * p_C);
  }
  /** Where the ray (x, y, 1) of F meets the image [px]. */
  Eigen::Vector2d toPixel(const CameraModel& camera, const Eigen::Vector2d& xy) const {
    if (ahead_) return camera.toPixel(xy.x(), xy.y());
    // Seams between faces of the cube run along diagonals of the image, exactly through centres of pixels. Moved by a
    // hair, they leave no centre to rounding, which would give it to neither face or to both.
    constexpr double kHair = 1e-7;  // [px]
    const Eigen::Vector2d px =
        camera.toPixel(Eigen::Vector3d(R_FC_.transpose() * Eigen::Vector3d(xy.x(), xy.y(), 1.0)));
    return {px.x() + kHair, px.y()};
  }

 private:
  friend class ViewVolume;
  void add(const Eigen::Vector3d& normal_F, double offset = 0.0);

  bool ahead_ = true;  // F is C, and this is the only cell
  Eigen::Matrix3d R_FC_ = Eigen::Matrix3d::Identity();
  static constexpr int kMostPlanes = 33;
  const Plane* begin() const { return planes_.data(); }
  const Plane* end() const { return planes_.data() + count_; }
  std::array<Plane, kMostPlanes> planes_;
  std::size_t count_ = 0;
};

/** What a camera can see, slightly widened: one cell ahead; through an equidistant lens that sees farther than 45
 *  degrees from its axis, up to five faces of a cube about the camera. */
class ViewVolume {
 public:
  explicit ViewVolume(const CameraModel& camera);
  /** The cells. Nothing here is allocated: there is one of these for each frame. */
  const ViewCell* begin() const { return cells_.data(); }
  const ViewCell* end() const { return cells_.data() + count_; }

 private:
  void addPinhole(const CameraModel& camera);
  void addCone(const CameraModel& camera);
  void addCube(const CameraModel& camera);

  static constexpr int kMostCells = 5;
  ViewCell& addCell() { return cells_[count_++]; }
  std::array<ViewCell, kMostCells> cells_;
  std::size_t count_ = 0;
};

}  // namespace aras_visual_servo_sim
