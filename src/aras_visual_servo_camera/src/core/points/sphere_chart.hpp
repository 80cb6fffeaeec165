#pragma once

#include <cmath>

#include "aras_visual_servo_camera/image/camera_intrinsics.hpp"
#include "points/point_tracker.hpp"

namespace aras_visual_servo_camera {

/** A point of the plane for each ray, for the tracker: as far from the origin
 * as the ray is from the optical axis [rad], in its direction. Near the axis
 * these are the normalised coordinates; a turn about the axis is one there,
 * too. */
inline ImagePoint chartOf(const CameraIntrinsics::Ray& ray) {
  const double aside = std::hypot(ray.x, ray.y);
  const double scale = aside > 0.0 ? std::atan2(aside, ray.z) / aside : 1.0;
  return {scale * ray.x, scale * ray.y};
}

}  // namespace aras_visual_servo_camera
