#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

namespace aras_visual_servo_sim {

/** Whether a closed mesh fills less than 0.9 of its convex hull, so that the hull cannot stand for it. */
bool isHollow(const std::vector<Eigen::Vector3d>& points, const std::vector<std::array<std::uint32_t, 3>>& triangles);

}  // namespace aras_visual_servo_sim
