#include "aras_visual_servo_sim/physics/ray_caster.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "aras_visual_servo_sim/config/errors.hpp"

namespace aras_visual_servo_sim::ray_caster_test {
namespace {

using Eigen::Vector3d;

constexpr double kRounding = 1e-12;  // of sums and products of a few numbers near 1

Geometry box(const Vector3d& size) {
  Geometry made;
  made.size_m = size;
  return made;
}

Geometry round(Geometry::Type type, double radius, double length = 0.0) {
  Geometry made;
  made.type = type;
  made.radius_m = radius;
  made.length_m = length;
  return made;
}

Pose tilted() {
  return {{0.3, -0.2, 0.5}, Eigen::Quaterniond(Eigen::AngleAxisd(0.7, Vector3d(1.0, 2.0, -0.5).normalized()))};
}

RayCaster::Hit one(const RayCaster& rays, const Vector3d& from, const Vector3d& to, double nearest = 0.0,
                   bool inside = true) {
  return rays.cast(from, {(to - from).normalized()}, nearest, 100.0, inside).front();
}

/** The triangles of a box, to be held against the box. */
std::vector<RayCaster::Triangle> trianglesOfBox(const Vector3d& size) {
  std::vector<RayCaster::Triangle> triangles;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double sign : {-1.0, 1.0}) {
      Vector3d out = Vector3d::Zero(), u = Vector3d::Zero(), v = Vector3d::Zero();
      out[axis] = 0.5 * sign * size[axis];
      u[(axis + 1) % 3] = 0.5 * size[(axis + 1) % 3];
      v[(axis + 2) % 3] = 0.5 * sign * size[(axis + 2) % 3];
      triangles.push_back({Vector3d(out - u - v), Vector3d(out + u - v), Vector3d(out + u + v)});
      triangles.push_back({Vector3d(out - u - v), Vector3d(out + u + v), Vector3d(out - u + v)});
    }
  }
  return triangles;
}

TEST(RayCaster, MeetsEachShapeWhereItsEquationSays) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> any(-1.0, 1.0);
  const Pose X = tilted();
  const Vector3d size(0.4, 0.6, 0.3);
  for (int shape = 0; shape < 3; ++shape) {
    RayCaster rays;
    if (shape == 0) rays.add(0, box(size), X);
    if (shape == 1) rays.add(0, round(Geometry::Type::kCylinder, 0.25, 0.6), X);
    if (shape == 2) rays.add(0, round(Geometry::Type::kSphere, 0.3), X);
    int hits = 0;
    for (int k = 0; k < 500; ++k) {
      const Vector3d from = X.p + 3.0 * Vector3d(any(random), any(random), any(random)).normalized();
      const Vector3d to = X.p + 0.3 * Vector3d(any(random), any(random), any(random));
      const auto hit = one(rays, from, to);
      if (hit.shape < 0) continue;
      ++hits;
      const auto outside = [&](double distance) {  // how far beyond the surface, by the largest of the shape's measures
        const Vector3d p = X.inverse() * (from + distance * (to - from).normalized());
        if (shape == 0) return (p.cwiseAbs() - 0.5 * size).maxCoeff();
        if (shape == 1) return std::max(p.head<2>().norm() - 0.25, std::abs(p.z()) - 0.3);
        return p.norm() - 0.3;
      };
      EXPECT_NEAR(outside(hit.distance_m), 0.0, kRounding);
      for (int part = 1; part < 20; ++part) EXPECT_GT(outside(hit.distance_m * part / 20.0), 0.0) << "it is the first";
    }
    EXPECT_GT(hits, 200);
  }
}

TEST(RayCaster, MeetsAMeshWhereItMeetsTheBoxThatTheMeshIs) {
  const Vector3d size(0.4, 0.6, 0.3);
  RayCaster exact, mesh;
  exact.add(3, box(size), Pose{});
  mesh.addMesh(3, trianglesOfBox(size), Pose{});
  exact.place(3, tilted());
  mesh.place(3, tilted());
  std::mt19937 random(11);
  std::uniform_real_distribution<double> any(-1.0, 1.0);
  for (const bool inside : {true, false}) {
    for (int k = 0; k < 500; ++k) {
      const Vector3d from = tilted().p + (k % 2 ? 2.0 : 0.1) * Vector3d(any(random), any(random), any(random));
      const Vector3d to = tilted().p + 0.4 * Vector3d(any(random), any(random), any(random));
      const double a = one(exact, from, to, 0.0, inside).distance_m;
      const double b = one(mesh, from, to, 0.0, inside).distance_m;
      ASSERT_EQ(std::isinf(a), std::isinf(b)) << k;
      if (!std::isinf(a)) {
        EXPECT_NEAR(a, b, 1e-9);
      }
    }
  }
}

TEST(RayCaster, MeetsTheNearestOfManyAndSaysWhich) {
  RayCaster rays;
  EXPECT_EQ(rays.add(0, round(Geometry::Type::kSphere, 0.5), Pose{{5.0, 0.0, 0.0}, Eigen::Quaterniond::Identity()}), 0);
  EXPECT_EQ(rays.add(1, box({1.0, 1.0, 1.0}), Pose{{3.0, 0.0, 0.0}, Eigen::Quaterniond::Identity()}), 1);
  EXPECT_EQ(rays.addPlane(2, Pose{{0.0, 0.0, -1.0}, Eigen::Quaterniond::Identity()}), 2);
  auto hit = one(rays, Vector3d::Zero(), {1.0, 0.0, 0.0});
  EXPECT_EQ(hit.shape, 1);
  EXPECT_NEAR(hit.distance_m, 2.5, kRounding);
  rays.place(1, Pose{{0.0, 10.0, 0.0}, Eigen::Quaterniond::Identity()});
  hit = one(rays, Vector3d::Zero(), {1.0, 0.0, 0.0});
  EXPECT_EQ(hit.shape, 0);
  EXPECT_NEAR(hit.distance_m, 4.5, kRounding);
  hit = one(rays, Vector3d::Zero(), {1.0, 0.0, -1.0});
  EXPECT_EQ(hit.shape, 2);
  EXPECT_NEAR(hit.distance_m, std::sqrt(2.0), kRounding);
}

TEST(RayCaster, BeginsAtTheNearestRangeAndEndsAtTheFarthest) {
  RayCaster rays;
  rays.add(0, round(Geometry::Type::kSphere, 1.0), Pose{});
  const std::vector<Vector3d> ahead{Vector3d::UnitX()};
  const Vector3d from(-4.0, 0.0, 0.0);
  EXPECT_NEAR(rays.cast(from, ahead, 0.0, 10.0, true)[0].distance_m, 3.0, kRounding);
  EXPECT_NEAR(rays.cast(from, ahead, 3.5, 10.0, true)[0].distance_m, 5.0, kRounding) << "it leaves the ball";
  EXPECT_EQ(rays.cast(from, ahead, 3.5, 10.0, false)[0].shape, -1) << "the ball is not met from inside";
  EXPECT_EQ(rays.cast(from, ahead, 0.0, 2.9, true)[0].shape, -1);
}

TEST(RayCaster, RefusesWhatIsNoShapeAndNoRay) {
  RayCaster rays;
  EXPECT_THROW(rays.add(0, box({1.0, 0.0, 1.0}), Pose{}), ModelError);
  EXPECT_THROW(rays.addMesh(0, {}, Pose{}), ModelError);
  EXPECT_THROW(rays.cast({0.0, 0.0, std::nan("")}, {Vector3d::UnitX()}, 0.0, 1.0, true), NotFiniteError);
  EXPECT_THROW(rays.cast(Vector3d::Zero(), {Vector3d::UnitX()}, 2.0, 1.0, true), ParameterError);
}

}  // namespace
}  // namespace aras_visual_servo_sim::ray_caster_test
