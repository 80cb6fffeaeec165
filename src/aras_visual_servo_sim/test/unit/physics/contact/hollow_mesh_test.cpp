#include <gtest/gtest.h>

#include "aras_visual_servo_sim/physics/contact_config.hpp"

namespace aras_visual_servo_sim::hollow_mesh_test {
namespace {

using Triangles = std::vector<std::array<std::uint32_t, 3>>;

TEST(HollowMesh, AProfileIsHollowWhenItsHullIsMuchLargerThanItself) {
  // The right angle of a prism: the corner (1, 1) of its profile moves inwards to (d, d) and leaves an L.
  for (const double d : {1.0, 0.6, 0.46, 0.44, 0.2}) {
    const std::vector<Eigen::Vector2d> profile = {{0, 0}, {1, 0}, {d, d}, {0, 1}};
    std::vector<Eigen::Vector3d> points;
    for (const double z : {0.0, 2.0}) {
      for (const Eigen::Vector2d& p : profile) points.emplace_back(p.x(), p.y(), z);
    }
    Triangles triangles = {{0, 2, 1}, {0, 3, 2}, {4, 5, 6}, {4, 6, 7}};
    for (std::uint32_t k = 0; k < 4; ++k) {
      const std::uint32_t next = (k + 1) % 4;
      triangles.push_back({k, next, next + 4});
      triangles.push_back({k, next + 4, k + 4});
    }
    const double area = d, hull = std::max(d, 0.5);  // of the profile
    EXPECT_EQ(isHollow(points, triangles), area < 0.9 * hull) << d;
  }
}

TEST(HollowMesh, AFlatSheetIsHollow) {
  EXPECT_TRUE(isHollow({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 3}}));
}

}  // namespace
}  // namespace aras_visual_servo_sim::hollow_mesh_test
