#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "aras_visual_servo_sim/config/types.hpp"

namespace aras_visual_servo_sim {

/** A `<light>` of SDF, in the frame A that the element stands in. */
struct SdfLight {
  enum class Type { kDirectional, kPoint, kSpot };
  std::string name;
  Type type = Type::kPoint;
  Pose X_AL;
  Eigen::Vector3d direction_A = -Eigen::Vector3d::UnitZ();                                ///< where its light goes
  Eigen::Vector3d diffuse = Eigen::Vector3d::Ones(), specular = Eigen::Vector3d::Ones();  ///< 0 .. 1, or more
  double range_m = 0.0, constant = 0.0, linear_per_m = 0.0, quadratic_per_m2 = 0.0;       ///< attenuation
  double inner_angle_rad = 0.0, outer_angle_rad = 0.0, falloff = 0.0;                     ///< of a spot
  bool casts_shadows = false;
};

/** Reads the text of one `<light>`, or of an `<sdf>` that begins with one. What is not given has SDF's defaults.
 *  @param source    of the text, for messages
 *  @param warnings  given a line for what is ignored; may be null
 *  @throws ModelError naming the element: no name, an unknown type, no direction, numbers that are none */
SdfLight readSdfLight(const std::string& xml, const std::string& source, std::vector<std::string>* warnings);

}  // namespace aras_visual_servo_sim
