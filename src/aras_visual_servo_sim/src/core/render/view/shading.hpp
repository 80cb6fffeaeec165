#pragma once

#include <Eigen/Core>
#include <algorithm>

namespace aras_visual_servo_sim {

/** Share of a surface's own colour that is seen of it: Lambert's law for a light from afar and a weak one at the
 * camera, over an ambient term.
 *  @param normal_C  outward, unit @param light_C  where the light travels, unit @param p_C  the point [m] */
inline double litShare(const Eigen::Vector3d& normal_C, const Eigen::Vector3d& light_C, const Eigen::Vector3d& p_C) {
  constexpr double kAmbient = 0.38, kLight = 0.50, kHeadlight = 0.22;
  const double lit = std::max(0.0, -normal_C.dot(light_C));
  const double head = std::max(0.0, -normal_C.dot(p_C) / (p_C.norm() + 1e-12));
  return std::min(1.0, kAmbient + kLight * lit + kHeadlight * head);
}

}  // namespace aras_visual_servo_sim
