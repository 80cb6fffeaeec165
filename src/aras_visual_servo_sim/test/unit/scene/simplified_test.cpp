// Meshes with fewer triangles: how many are left, where they are, and how they answer light.
#include "scene/mesh/simplified.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

namespace aras_visual_servo_sim::simplified_test {
namespace {

/** A ball of many triangles that nobody knows to be one. @param faceted  each triangle with a normal of its own */
TriangleMesh ball(int sides, bool faceted = false) {
  TriangleMesh mesh = *makeSphere(1.0, sides);
  mesh.round.reset();
  if (!faceted) return mesh;
  TriangleMesh made;
  for (const auto& t : mesh.triangles) {
    const auto first = static_cast<std::uint32_t>(made.points.size());
    const Eigen::Vector3f a = mesh.points[t[0]], b = mesh.points[t[1]], c = mesh.points[t[2]];
    for (const Eigen::Vector3f& point : {a, b, c}) {
      made.points.push_back(point);
      made.normals.push_back((b - a).cross(c - a).normalized());
    }
    made.triangles.push_back({first, first + 1, first + 2});
  }
  made.finish();
  return made;
}

/** A box whose faces are grids of triangles, each face with normals of its own; +z is red, the rest white. */
TriangleMesh finelyCutBox(int cuts) {
  TriangleMesh mesh;
  for (int axis = 0; axis < 3; ++axis) {
    for (const float side : {-1.0f, 1.0f}) {
      const Eigen::Vector3f n = side * Eigen::Vector3f::Unit(axis), e1 = Eigen::Vector3f::Unit((axis + 1) % 3);
      const Eigen::Vector3f e2 = n.cross(e1);
      const auto first = static_cast<std::uint32_t>(mesh.points.size());
      for (int i = 0; i <= cuts; ++i) {
        for (int k = 0; k <= cuts; ++k) {
          mesh.points.emplace_back(n + (2.0f * i / cuts - 1.0f) * e1 + (2.0f * k / cuts - 1.0f) * e2);
          mesh.normals.push_back(n);
          mesh.colors.push_back(axis == 2 && side > 0.0f ? Rgb{255, 0, 0} : Rgb{255, 255, 255});
        }
      }
      for (int i = 0; i < cuts; ++i) {
        for (int k = 0; k < cuts; ++k) {
          const auto at = static_cast<std::uint32_t>(first + i * (cuts + 1) + k), next = at + cuts + 1;
          mesh.triangles.push_back({at, next, next + 1});
          mesh.triangles.push_back({at, next + 1, at + 1});
        }
      }
    }
  }
  mesh.finish();
  return mesh;
}

Eigen::Vector3f normalOf(const TriangleMesh& mesh, const std::array<std::uint32_t, 3>& t) {
  const Eigen::Vector3f a = mesh.points[t[1]] - mesh.points[t[0]], b = mesh.points[t[2]] - mesh.points[t[0]];
  return a.cross(b).normalized();
}

TEST(Simplified, StaysWithinTheErrorOfABall) {
  const TriangleMesh mesh = ball(256);
  ASSERT_GT(mesh.triangles.size(), 50000u);
  std::size_t before = mesh.triangles.size();
  for (const double error : {1e-3, 4e-3, 16e-3}) {
    const MeshPtr made = simplified(mesh, error).mesh;
    ASSERT_TRUE(made);
    EXPECT_LT(made->triangles.size(), before / 2) << error;
    before = made->triangles.size();
    for (const auto& t : made->triangles) {
      const Eigen::Vector3f middle = (made->points[t[0]] + made->points[t[1]] + made->points[t[2]]) / 3.0f;
      EXPECT_NEAR(middle.norm(), 1.0, 4.0 * error);
      for (const std::uint32_t i : t) EXPECT_GT(made->normals[i].dot(made->points[i]), 0.8f);
    }
  }
}

TEST(Simplified, FacetsGetNormalsOfTheirOwn) {
  const MeshPtr made = simplified(ball(64, /*faceted=*/true), 4e-3).mesh;
  ASSERT_TRUE(made);
  EXPECT_TRUE(isFaceted(*made));
  for (const auto& t : made->triangles) EXPECT_GT(made->normals[t[0]].dot(normalOf(*made, t)), 0.999f);
}

TEST(Simplified, FlatFacesCreasesAndColoursStay) {
  const TriangleMesh mesh = finelyCutBox(20);
  const Simplified fewer = simplified(mesh, 1e-3);
  const MeshPtr made = fewer.mesh;
  ASSERT_TRUE(made);
  EXPECT_LT(made->triangles.size(), mesh.triangles.size() / 20);
  EXPECT_LE(fewer.error_m, 1e-3);
  for (const auto& t : made->triangles) {
    const Eigen::Vector3f face = normalOf(*made, t);
    EXPECT_NEAR(face.cwiseAbs().maxCoeff(), 1.0, 1e-5);
    const bool red = face.z() > 0.5f;
    for (const std::uint32_t i : t) {
      EXPECT_GT(made->normals[i].dot(face), 0.999f);
      EXPECT_EQ(made->colors[i], (red ? Rgb{255, 0, 0} : Rgb{255, 255, 255}));
    }
  }
}

TEST(Simplified, NothingWhereLittleWouldGo) {
  EXPECT_EQ(simplified(ball(64), 1e-7).mesh, nullptr);
  EXPECT_EQ(simplified(*makeBox({1.0, 1.0, 1.0}), 1e-3).mesh, nullptr);
}

}  // namespace
}  // namespace aras_visual_servo_sim::simplified_test
