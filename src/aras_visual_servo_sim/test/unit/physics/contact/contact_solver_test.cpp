// The impulses of one step, by the solver itself: points that touch each other, and a joint that they push.
#include "physics/contact/contact_solver.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <random>

namespace aras_visual_servo_sim::contact_solver_test {
namespace {

constexpr double kStiffness = 1e4, kDamping = 5.0, kDt = 0.01, kDepth = 1e-4;
constexpr double kRate = kDt * kStiffness + kDamping;  // force for a speed held over the step
constexpr double kWanted = kStiffness * kDepth / kRate, kCompliance = 1.0 / (kDt * kRate);
constexpr double kTolerance = 1e-8;  // of impulses of about 1

/** Points that answer to impulses by S and approach at 1 m/s while they slip. */
ContactRows touching(const Eigen::MatrixXd& S) {
  ContactRows rows;
  const auto points = static_cast<std::size_t>(S.rows() / 3);
  rows.J.resize(S.rows(), 0);
  rows.S = S;
  rows.u0 = Eigen::Vector3d(-1.0, 0.8, -0.4).replicate(S.rows() / 3, 1);
  rows.depth_m.assign(points, kDepth);
  for (std::size_t k = 0; k < points; ++k) rows.friction.push_back(0.1 + 0.2 * static_cast<double>(k % 4));
  return rows;
}

struct Solved {
  Eigen::VectorXd lambda;
  bool settled;
};

Solved solve(const ContactRows& rows) {
  ContactSolver solver(kStiffness, kDamping);
  JointSolver joints(0);
  Eigen::VectorXd v(0), effort(0);
  const Eigen::VectorXd lambda = solver.solve(rows, {}, Eigen::VectorXd(0), {}, kDt, joints, v, effort);
  return {lambda, solver.settled()};
}

/** Each point answers to itself and to its neighbours in the row. */
Eigen::MatrixXd chain(int points, double own = 1.0) {
  Eigen::MatrixXd S = own * Eigen::MatrixXd::Identity(3 * points, 3 * points);
  for (int k = 0; k + 1 < points; ++k) {
    S.block<3, 3>(3 * k, 3 * k + 3).diagonal().setConstant(0.3);
    S.block<3, 3>(3 * k + 3, 3 * k).diagonal().setConstant(0.3);
  }
  return S;
}

/** D of points at random on bodies with 18 velocities: Gauss-Seidel needs many sweeps. */
Eigen::MatrixXd crowd(int points) {
  std::mt19937 random(9);
  std::normal_distribution<double> normal;
  const Eigen::MatrixXd G = Eigen::MatrixXd::NullaryExpr(3 * points, 18, [&] { return normal(random); });
  return G * G.transpose();
}

Eigen::MatrixXd besideEachOther(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B) {
  Eigen::MatrixXd S = Eigen::MatrixXd::Zero(A.rows() + B.rows(), A.rows() + B.rows());
  S.topLeftCorner(A.rows(), A.rows()) = A;
  S.bottomRightCorner(B.rows(), B.rows()) = B;
  return S;
}

TEST(ContactSolver, PointsThatActThroughOthersAreSolvedTogether) {
  const ContactRows rows = touching(chain(4));
  const Solved solved = solve(rows);
  EXPECT_TRUE(solved.settled);
  const Eigen::VectorXd u = rows.u0 + rows.S * solved.lambda;
  for (int k = 0; k < 4; ++k) {
    SCOPED_TRACE(k);
    const double pressed = solved.lambda[3 * k];
    EXPECT_GT(pressed, 0.0);
    EXPECT_NEAR(u[3 * k] + kCompliance * pressed, kWanted, kTolerance);
    const Eigen::Vector2d drag = solved.lambda.segment<2>(3 * k + 1), slip = u.segment<2>(3 * k + 1);
    const double radius = rows.friction[k] * pressed;
    EXPECT_LE(drag.norm(), radius + kTolerance);
    if (drag.norm() < radius - 1e-5) {
      EXPECT_LT(slip.norm(), 1e-6);
    } else {
      EXPECT_NEAR(drag.dot(slip), -radius * slip.norm(), kTolerance);
    }
  }
}

TEST(ContactSolver, PointsThatDoNotActOnEachOtherGetTheBytesTheyWouldGetAlone) {
  const Eigen::MatrixXd one = chain(4), other = chain(5, 1.7);
  const Eigen::VectorXd both = solve(touching(besideEachOther(one, other))).lambda;
  EXPECT_EQ(both.head(12), solve(touching(one)).lambda);
}

TEST(ContactSolver, TheSweepsOfAStepAreBoundedByItsPoints) {
  const Eigen::MatrixXd hard = crowd(20);
  EXPECT_TRUE(solve(touching(hard)).settled);
  const Solved many = solve(touching(besideEachOther(hard, Eigen::MatrixXd::Identity(1920, 1920))));
  EXPECT_FALSE(many.settled);
  EXPECT_TRUE(many.lambda.allFinite());
}

struct Pushed {
  double impulse, v;
  bool settled;
};

/** A joint of 1 kg at rest that a contact pushes at 1 m/s, beside points that do not touch. */
Pushed pushed(double friction, double damping, int apart = 0) {
  const int points = 1 + apart;
  ContactRows rows;
  rows.J.setZero(3 * points, 1);
  rows.J(0, 0) = 1.0;
  rows.S.setIdentity(3 * points, 3 * points);
  rows.S.topLeftCorner<3, 3>().setZero();
  rows.u0.setZero(3 * points);
  for (int k = 0; k < points; ++k) rows.u0[3 * k] = k == 0 ? -1.0 : 1.0;
  rows.depth_m.assign(points, kDepth);
  rows.friction.assign(points, 0.5);
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  std::vector<JointGraph> graphs(1);
  graphs[0].build(ActuatorLaw{}, damping, friction, -kInfinity, kInfinity);
  ContactSolver solver(kStiffness, kDamping);
  JointSolver joints(1);
  const Eigen::VectorXd v_free = Eigen::VectorXd::Zero(1);
  Eigen::VectorXd v = v_free, effort = v_free;
  const double impulse = solver.solve(rows, {1.0}, v_free, graphs, kDt, joints, v, effort)[0];
  return {impulse, v[0], solver.settled()};
}

TEST(ContactSolver, AJointThatIsHeldStaysAndTheContactGivesWay) {
  const Pushed found = pushed(1000.0, 0.0);
  EXPECT_TRUE(found.settled);
  EXPECT_EQ(found.v, 0.0);
  EXPECT_NEAR(found.impulse, (kWanted + 1.0) / kCompliance, kTolerance);
}

TEST(ContactSolver, AJointThatSlidesGivesWayAsFrictionAndDampingLetIt) {
  for (const auto& [friction, damping] : {std::pair{10.0, 0.0}, {0.0, 70.0}, {10.0, 70.0}}) {
    SCOPED_TRACE(friction + damping);
    const Pushed found = pushed(friction, damping);
    EXPECT_TRUE(found.settled);
    EXPECT_GT(found.v, 0.1);
    EXPECT_NEAR(found.v * (1.0 + kDt * damping), found.impulse - kDt * friction, kTolerance);
    EXPECT_NEAR(found.impulse, (kWanted + 1.0 - found.v) / kCompliance, kTolerance);
  }
}

TEST(ContactSolver, TheRoundsOfAStepAreBoundedByItsPoints) {
  EXPECT_TRUE(pushed(10.0, 0.0, 100).settled);
  EXPECT_FALSE(pushed(10.0, 0.0, 650).settled);
}

}  // namespace
}  // namespace aras_visual_servo_sim::contact_solver_test
