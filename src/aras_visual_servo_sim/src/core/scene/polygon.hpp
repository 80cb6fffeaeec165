#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

namespace aras_visual_servo_sim {

/** Area of a closed polygon, positive when counter-clockwise (x right, y up). */
double signedArea(const std::vector<Eigen::Vector2d>& polygon);

/** Whether two edges that are not neighbours meet. */
bool crossesItself(const std::vector<Eigen::Vector2d>& polygon);

/** Cuts a simple counter-clockwise polygon into triangles by clipping ears; corners on a straight edge are allowed. */
std::vector<std::array<std::uint32_t, 3>> triangulate(const std::vector<Eigen::Vector2d>& polygon);

}  // namespace aras_visual_servo_sim
