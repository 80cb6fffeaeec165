// Heaps that nobody would build: the work of a step is bounded, what comes out is finite.
#include <Eigen/Cholesky>
#include <random>

#include "physics/contact/contact_island.hpp"
#include "tools/heap.hpp"
#include "tools/physics_tools.hpp"

namespace aras_visual_servo_sim::contact_bound_test {
namespace {

constexpr double kTolerance = 1e-8;  // of the largest impulse

/** Points that touch bodies of `dofs` velocities in all, at random: far more rows than velocities. */
ContactIsland crowded(std::mt19937& random, int dofs, int points) {
  std::normal_distribution<double> normal;
  ContactIsland island;
  island.resize(points);
  const Eigen::MatrixXd G = Eigen::MatrixXd::NullaryExpr(3 * points, dofs, [&] { return normal(random); });
  const Eigen::MatrixXd B = Eigen::MatrixXd::NullaryExpr(dofs, dofs, [&] { return normal(random); });
  const Eigen::MatrixXd M = B * B.transpose() + Eigen::MatrixXd::Identity(dofs, dofs);
  island.D = G * M.llt().solve(G.transpose());
  island.u = G * Eigen::VectorXd::NullaryExpr(dofs, [&] { return normal(random); });
  island.lambda.setZero();
  for (int k = 0; k < points; ++k) {
    island.wanted[k] = 0.1;
    island.compliance[k] = 0.01;
    island.friction[k] = 0.1 * (1 + k % 8);
  }
  return island;
}

void expectWithinCones(const ContactIsland& island, double scale) {
  for (int k = 0; k < island.points(); ++k) {
    EXPECT_GE(island.lambda[3 * k], 0.0);
    EXPECT_LE(island.lambda.segment<2>(3 * k + 1).norm(),
              island.friction[k] * island.lambda[3 * k] + kTolerance * scale);
  }
}

TEST(ContactBound, ManyPointsAreSolvedInTheVelocitiesOfFewBodies) {
  std::mt19937 random(3);
  for (const int dofs : {6, 12}) {
    for (int k = 0; k < 5; ++k) {
      SCOPED_TRACE(dofs);
      ContactIsland island = crowded(random, dofs, 152);
      const Eigen::VectorXd u_free = island.u;
      EXPECT_TRUE(island.solve());
      const double scale = std::max(1.0, island.lambda.lpNorm<Eigen::Infinity>());
      EXPECT_LT((u_free + island.D * island.lambda - island.u).lpNorm<Eigen::Infinity>(), 1e-9 * scale);
      expectWithinCones(island, scale);
      for (int point = 0; point < island.points(); ++point) {
        const double pressed = island.lambda[3 * point];
        const double gap = island.u[3 * point] + island.compliance[point] * pressed - island.wanted[point];
        EXPECT_GE(gap, -kTolerance * scale);
        EXPECT_NEAR(pressed * gap, 0.0, kTolerance * scale * scale);
        const Eigen::Vector2d drag = island.lambda.segment<2>(3 * point + 1), slip = island.u.segment<2>(3 * point + 1);
        if (drag.norm() < island.friction[point] * pressed - 1e-5 * scale) {
          EXPECT_LT(slip.norm(), 1e-6 * scale);
        } else {
          EXPECT_NEAR(drag.dot(slip), -drag.norm() * slip.norm(), 1e-6 * scale * scale);
        }
      }
    }
  }
}

TEST(ContactBound, ManyPointsOfManyBodiesAreSweptWithoutNewtonsSteps) {
  std::mt19937 random(5);
  ContactIsland island = crowded(random, 6, 40);
  island.D.setIdentity();  // each row a body of its own
  island.u.setConstant(-1.0);
  EXPECT_TRUE(island.solve());
  EXPECT_LE(island.sweeps(), 3);
  for (int k = 0; k < 40; ++k) EXPECT_NEAR(island.lambda[3 * k], 1.1 / 1.01, 1e-12);
}

TEST(ContactBound, OutOfSweepsTheImpulsesAreWithinTheCones) {
  std::mt19937 random(9);
  for (const int points : {20, 60}) {
    ContactIsland island = crowded(random, 18, points);
    EXPECT_FALSE(island.solve(4));
    EXPECT_LE(island.sweeps(), 4);
    EXPECT_TRUE(island.lambda.allFinite());
    expectWithinCones(island, std::max(1.0, island.lambda.lpNorm<Eigen::Infinity>()));
  }
}

TEST(ContactBound, TwoHundredHeapsStayFinite) {
  const RobotModel model = modelOf(readUrdf("slider.urdf"));
  for (unsigned seed = 0; seed < 200; ++seed) {
    SCOPED_TRACE(seed);
    MultibodyWorld world(model, heap(seed, 2 + static_cast<int>(seed % 6)));
    world.step(5);
    for (const Obstacle& solid : world.config().contacts.obstacles) {
      const Pose pose = world.obstaclePose(solid.name);
      EXPECT_TRUE(pose.p.allFinite() && pose.q.coeffs().allFinite());
      EXPECT_LT(pose.p.norm(), 10.0);
    }
    for (const ContactForce& contact : world.contacts()) EXPECT_TRUE(contact.force_W.allFinite());
  }
}

TEST(ContactBound, StepsThatDoNotSettleAreCountedUntilAReset) {
  MultibodyWorld resting(modelOf(readUrdf("slider.urdf")), heap(1, 1));
  resting.step(5);
  EXPECT_EQ(resting.unsettledSteps(), 0u);
  std::uint64_t unsettled = 0;
  for (unsigned seed = 0; seed < 10; ++seed) {
    MultibodyWorld world(modelOf(readUrdf("slider.urdf")), heap(seed, 12));
    world.step(2);
    unsettled += world.unsettledSteps();
    EXPECT_LE(world.unsettledSteps(), 2u);
    world.reset(world.jointPositions());
    EXPECT_EQ(world.unsettledSteps(), 0u);
  }
  EXPECT_GT(unsettled, 0u);
}

}  // namespace
}  // namespace aras_visual_servo_sim::contact_bound_test
