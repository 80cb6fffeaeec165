#pragma once

#include <Eigen/Core>
#include <vector>

#include "aras_visual_servo_sim/camera_model.hpp"

namespace aras_visual_servo_sim {

/** What a camera can see, in its frame C: beyond the near plane and inside a cone about the image, slightly widened.
 *
 *  Everything drawn is clipped to it, so that projecting never divides by zero nor leaves the radius at which a lens
 *  folds over. The planes beyond the near one meet in the origin. */
class ViewVolume {
 public:
  explicit ViewVolume(const CameraModel& camera);

  /** Half-space normal . p >= offset, |normal| = 1. */
  struct Plane {
    Eigen::Vector3d normal;
    double offset;
  };
  const std::vector<Plane>& planes() const { return planes_; }

  /** Whether a ball lies wholly outside one of the planes. */
  bool excludes(const Eigen::Vector3d& center_C, double radius) const;
  /** Whether a ball lies wholly inside all of them. */
  bool contains(const Eigen::Vector3d& center_C, double radius) const;
  /** Whether all points lie outside one and the same plane. */
  bool excludes(const Eigen::Vector3d* points_C, std::size_t count) const;
  /** Cuts a polygon (Sutherland and Hodgman): what is left may be empty. Concave ones keep edges of no area. */
  void clip(std::vector<Eigen::Vector3d>& polygon_C) const;

 private:
  std::vector<Plane> planes_;
  mutable std::vector<Eigen::Vector3d> scratch_;
};

}  // namespace aras_visual_servo_sim
