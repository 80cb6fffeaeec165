#include "physics/contact/contact_island.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <random>

#include "physics/contact/contact_points.hpp"

namespace aras_visual_servo_sim::contact_island_test {
namespace {

constexpr double kTolerance =
    1e-8;  // of the largest impulse: far above where sweeps end, far below any change of branch

/** A body of `dofs` velocities touched at `points`, at random; more rows than velocities from 3 points on. */
ContactIsland randomIsland(std::mt19937& random, int dofs, int points) {
  std::normal_distribution<double> normal;
  const auto draw = [&] { return normal(random); };
  const Eigen::MatrixXd G = Eigen::MatrixXd::NullaryExpr(3 * points, dofs, draw);
  const Eigen::MatrixXd B = Eigen::MatrixXd::NullaryExpr(dofs, dofs, draw);
  const Eigen::MatrixXd M = B * B.transpose() + Eigen::MatrixXd::Identity(dofs, dofs);
  ContactIsland island;
  island.resize(points);
  island.D = G * M.llt().solve(G.transpose());
  island.u = G * Eigen::VectorXd::NullaryExpr(dofs, draw);
  island.lambda.setZero();
  for (int k = 0; k < points; ++k) {
    island.wanted[k] = 0.1;
    island.compliance[k] = 0.01;
    island.friction[k] = 0.1 * (1 + k % 8);
  }
  return island;
}

/** Signorini's and Coulomb's conditions at every point. */
void expectSolved(const ContactIsland& island, const Eigen::VectorXd& u_free) {
  const double scale = std::max(1.0, island.lambda.lpNorm<Eigen::Infinity>());
  EXPECT_LT((u_free + island.D * island.lambda - island.u).lpNorm<Eigen::Infinity>(), 1e-9 * scale);
  for (int k = 0; k < island.points(); ++k) {
    const double pressed = island.lambda[3 * k];
    const double gap = island.u[3 * k] + island.compliance[k] * pressed - island.wanted[k];
    EXPECT_GE(pressed, 0.0);
    EXPECT_GE(gap, -kTolerance * scale);
    EXPECT_NEAR(pressed * gap, 0.0, kTolerance * scale * scale);
    const Eigen::Vector2d drag = island.lambda.segment<2>(3 * k + 1);
    const Eigen::Vector2d slip = island.u.segment<2>(3 * k + 1);
    const double radius = island.friction[k] * pressed;
    EXPECT_LE(drag.norm(), radius + kTolerance * scale);
    if (drag.norm() < radius - 1e-5 * scale) {
      EXPECT_LT(slip.norm(), 1e-6 * scale) << "inside the cone nothing slips";
    } else {
      EXPECT_NEAR(drag.dot(slip), -radius * slip.norm(), 1e-6 * scale * scale) << "on it the drag is against the slip";
    }
  }
}

TEST(ContactIsland, FulfilsTheConditionsOfContactAndFriction) {
  std::mt19937 random(7);
  long sweeps = 0;
  for (int k = 0; k < 300; ++k) {
    SCOPED_TRACE(k);
    ContactIsland island = randomIsland(random, 3 + k % 10, 1 + k % 4);
    const Eigen::VectorXd u_free = island.u;
    island.solve();
    expectSolved(island, u_free);
    sweeps += island.sweeps();
  }
  EXPECT_LT(sweeps, 300 * 40);  // Gauss-Seidel alone takes thousands where a face is touched at four points
}

TEST(ContactIsland, WithoutFrictionNothingDragsAndWithoutTouchNothingActs) {
  std::mt19937 random(11);
  ContactIsland island = randomIsland(random, 6, 4);
  island.friction.assign(4, 0.0);
  island.solve();
  for (int k = 0; k < 4; ++k) EXPECT_EQ(island.lambda.segment<2>(3 * k + 1), Eigen::Vector2d::Zero());
  island = randomIsland(random, 6, 2);
  island.u << 5.0, 1.0, 1.0, 5.0, 1.0, 1.0;  // both fly away
  island.solve();
  EXPECT_EQ(island.lambda, Eigen::VectorXd::Zero(6));
}

TEST(ContactIsland, WhatCannotMoveSidewaysIsNotDragged) {
  ContactIsland island;
  island.resize(1);
  island.D.setZero();
  island.D(0, 0) = 2.0;
  island.u << -1.0, 0.0, 0.0;
  island.lambda.setZero();
  island.wanted[0] = 0.0;
  island.compliance[0] = 0.5;
  island.friction[0] = 1.0;
  island.solve();
  EXPECT_NEAR(island.lambda[0], 1.0 / 2.5, 1e-12);
  EXPECT_EQ(island.lambda.tail<2>(), Eigen::Vector2d(0.0, 0.0));
}

/** Rigid points in one place that are to part at different speeds: Newton's equations have no solution, sweeps do. */
TEST(ContactIsland, OfTwoRigidPointsInOnePlaceTheFasterOneCarriesAll) {
  ContactIsland island;
  island.resize(2);
  island.D.setZero();
  for (const int i : {0, 3}) {
    for (const int j : {0, 3}) island.D(i, j) = 2.0;
  }
  island.u << -1.0, 0.0, 0.0, -1.0, 0.0, 0.0;
  island.lambda.setZero();
  island.wanted = {0.0, 0.1};
  island.compliance.assign(2, 0.0);
  island.friction.assign(2, 1.0);
  EXPECT_TRUE(island.solve());
  EXPECT_NEAR(island.lambda[0], 0.0, 1e-12);
  EXPECT_NEAR(island.lambda[3], 0.55, 1e-12);
}

TEST(ContactIsland, AStiffAndAWeakDirectionAcrossAPointAreSweptToRest) {
  ContactIsland island;
  island.resize(1);
  island.D = Eigen::Vector3d(1.0, 0.1, 4.0).asDiagonal();
  island.u << -1.0, 0.01, 0.4;
  island.lambda << 1.0, 0.001, 0.001;  // no first step of Newton's
  island.u += island.D * island.lambda;
  island.wanted.assign(1, 0.0);
  island.compliance.assign(1, 0.01);
  island.friction.assign(1, 2.0);
  EXPECT_TRUE(island.solve());
  EXPECT_NEAR(island.lambda[1], -0.1, 1e-6);
  EXPECT_NEAR(island.lambda[2], -0.1, 1e-6);
}

std::vector<ContactPoint> pointsAt(const std::vector<Eigen::Vector3d>& places) {
  std::vector<ContactPoint> points;
  for (const Eigen::Vector3d& place : places) points.push_back({0, 1, place, Eigen::Vector3d::UnitZ(), 1e-6, 0.5});
  return points;
}

TEST(ContactPoints, OfACutFaceOnlyItsCornersCount) {
  const std::vector<Eigen::Vector3d> corners = {{1, 1, 0}, {-1, 1, 0}, {-1, -1, 0}, {1, -1, 0}};
  std::vector<Eigen::Vector3d> cut = corners;
  cut.insert(cut.begin() + 2, {-1.0, 0.3, 0.0});          // on an edge
  cut.insert(cut.begin() + 4, {1e-9 - 1, -1e-9 - 1, 0});  // twice
  cut.emplace_back(1.0, 1.0, 0.0);
  std::vector<ContactPoint> points = pointsAt({{9, 9, 9}});
  for (const ContactPoint& point : pointsAt(cut)) points.push_back(point);
  keepCorners(points, 1);
  ASSERT_EQ(points.size(), 5u);
  EXPECT_EQ(points[0].point, Eigen::Vector3d(9, 9, 9));  // of another contact
  for (const Eigen::Vector3d& corner : corners) {
    EXPECT_TRUE(std::any_of(points.begin() + 1, points.end(),
                            [&](const auto& point) { return (point.point - corner).norm() < 1e-8; }));
  }
}

TEST(ContactPoints, ALineHasTwoEndsAndAPointIsKept) {
  std::vector<ContactPoint> line = pointsAt({{0, 0, 0}, {0.2, 0.1, 0}, {0.4, 0.2, 0}, {0.1, 0.05, 0}});
  keepCorners(line, 0);
  EXPECT_EQ(line.size(), 2u);
  std::vector<ContactPoint> one = pointsAt({{0.3, 0, 0}, {0.3, 1e-8, 0}});
  keepCorners(one, 0);
  EXPECT_EQ(one.size(), 1u);
}

TEST(ContactPoints, APointLessThanAMicrometreOffAnEdgeIsNoCorner) {
  std::vector<ContactPoint> points = pointsAt({{1, 1, 0}, {-1, 1, 0}, {-1, -1, 0}, {1, -1, 0}, {0.1, -1.0000005, 0}});
  keepCorners(points, 0);
  EXPECT_EQ(points.size(), 4u);
}

TEST(ContactPoints, UpToEightOfAFaceAreKept) {
  for (const std::size_t count : {5, 8}) {
    std::vector<ContactPoint> points = pointsAt(std::vector<Eigen::Vector3d>(count, Eigen::Vector3d::Zero()));
    thinOut(points, 0);
    EXPECT_EQ(points.size(), count);
  }
}

TEST(ContactPoints, ManyAreThinnedToFourFarApart) {
  std::vector<Eigen::Vector3d> ring;
  for (int k = 0; k < 40; ++k) ring.emplace_back(std::cos(0.157 * k), std::sin(0.157 * k), 0.0);
  std::vector<ContactPoint> points = pointsAt(ring);
  points[7].depth_m = 2e-6;
  thinOut(points, 0);
  ASSERT_EQ(points.size(), 4u);
  EXPECT_EQ(points[0].point, ring[7]);
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < i; ++j) EXPECT_GT((points[i].point - points[j].point).norm(), 1.2);
  }
}

}  // namespace
}  // namespace aras_visual_servo_sim::contact_island_test
