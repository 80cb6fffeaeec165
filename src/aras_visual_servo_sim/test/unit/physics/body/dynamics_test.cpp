#include <cmath>

#include "physics/body/articulated_body.hpp"
#include "tools/physics_tools.hpp"

namespace aras_visual_servo_sim::dynamics_test {
namespace {

constexpr double kEps = 2.2e-16;

/** Mean period of the pendulum over `count` swings, from the crossings of q = 0, interpolated. */
double measuredPeriod(double amplitude_rad, int count) {
  WorldConfig config;
  MultibodyWorld world(modelOf(readUrdf("pendulum.urdf")), config);
  world.reset(vectorOf({amplitude_rad}));
  double first = 0.0, before = amplitude_rad;
  for (int crossings = 0;;) {
    world.step();
    const double now = world.jointPositions()[0];
    if (before > 0.0 && now <= 0.0) {
      const double time = config.period_s * (static_cast<double>(world.ticks()) - now / (now - before));
      if (crossings == 0) first = time;
      if (crossings++ == count) return (time - first) / count;
    }
    before = now;
    if (world.ticks() > 100000) return -1.0;
  }
}

const double kPendulumInertia = 0.05 + 2.0 * 0.5 * 0.5;
const double kPendulumRate = std::sqrt(2.0 * kGravity * 0.5 / kPendulumInertia);

// Semi-implicit Euler shifts the rate of an oscillator by (w dt)^2 / 24 of itself; interpolating the crossings adds as
// much again: (w dt)^2 bounds both.
const double kPeriodTolerance = std::pow(kPendulumRate * 0.001, 2);

TEST(Dynamics, SmallPendulumHasThePeriodOfTheCompoundPendulum) {
  const double amplitude = 1e-4;  // changes the period by amplitude^2 / 16 of itself, far below the tolerance
  const double expected = 2.0 * kPi / kPendulumRate;
  EXPECT_NEAR(measuredPeriod(amplitude, 20) / expected, 1.0, kPeriodTolerance);
}

TEST(Dynamics, LargePendulumHasThePeriodOfTheEllipticIntegral) {
  const double amplitude = 2.0;
  const double expected = 4.0 / kPendulumRate * std::comp_ellint_1(std::sin(amplitude / 2.0));
  EXPECT_NEAR(measuredPeriod(amplitude, 20) / expected, 1.0, kPeriodTolerance);
}

TEST(Dynamics, MassMatrixOfACompoundBodyIsTheSumOverItsPartsAboutTheTiltedAxis) {
  std::string urdf = readUrdf("tilted_chain.urdf");
  urdf = replaced(urdf, "<joint name=\"elbow\" type=\"continuous\">", "<joint name=\"elbow\" type=\"fixed\">");
  urdf = replaced(urdf, "<joint name=\"drawer\" type=\"prismatic\">", "<joint name=\"drawer\" type=\"fixed\">");
  const RobotModel model = modelOf(urdf);
  MultibodyWorld world(model, weightless());
  const Joint& joint = model.movingJoint(0);
  const Pose X_WJ = world.linkPose("upper");
  const Eigen::Vector3d axis_W = X_WJ.q * joint.axis;
  double expected = 0.0;
  for (const Link& link : model.links) {
    if (link.mass_kg == 0.0) continue;
    const Pose X_WL = world.linkPose(link.name);
    const Eigen::Vector3d axis_L = X_WL.q.conjugate() * axis_W;
    const Eigen::Vector3d arm = axis_W.cross(X_WL * link.com_m - X_WJ.p);
    expected += axis_L.dot(link.inertia_kg_m2 * axis_L) + link.mass_kg * arm.squaredNorm();
  }
  // Some hundred roundings of numbers of the size of the result.
  EXPECT_NEAR(world.massMatrix()(0, 0), expected, 1000 * kEps * expected);
}

TEST(Dynamics, MassMatrixIsTheInverseOfWhatBulletAnswersToUnitEfforts) {
  const RobotModel model = modelOf(readUrdf("tilted_chain.urdf"));
  ArticulatedBody body(model, Eigen::Vector3d(0.0, 0.0, -kGravity), false, Pose{});
  body.setPositions(vectorOf({0.4, -1.1, 2.3}));
  std::vector<double> M;
  body.massMatrix(M);
  Eigen::VectorXd ignored(3), a;
  body.freeVelocities(vectorOf({0.0, 0.0, 0.0}), 0.001, ignored);
  for (int i = 0; i < 3; ++i) {
    Eigen::VectorXd unit = Eigen::VectorXd::Zero(3);
    unit[i] = 1.0;
    body.accelerations(unit, a);
    const Eigen::VectorXd back = Eigen::Map<const Eigen::MatrixXd>(M.data(), 3, 3) * a;
    // Roundings grow with the condition number of M, below 1e3 here.
    EXPECT_LT((back - unit).norm(), 1e3 * 100 * kEps) << "column " << i;
  }
}

TEST(Dynamics, MassMatrixGivesTheKineticEnergyOfTheLinksSummedOneByOne) {
  const RobotModel model = modelOf(readUrdf("tilted_chain.urdf"));
  MultibodyWorld world(model, weightless());
  world.reset(vectorOf({0.4, -1.1, 2.3}));
  const Eigen::VectorXd v = vectorOf({0.7, -1.9, 1.3});
  world.setJointVelocities(v);
  double expected = 0.0;
  for (const Link& link : model.links) {
    const Twist V = world.linkTwist(link.name);
    const Eigen::Vector3d omega = V.tail<3>();
    const Eigen::Vector3d velocity = V.head<3>() + omega.cross(link.com_m);
    expected += 0.5 * link.mass_kg * velocity.squaredNorm() + 0.5 * omega.dot(link.inertia_kg_m2 * omega);
  }
  EXPECT_NEAR(world.energy(), expected, 1000 * kEps * expected);
}

TEST(Dynamics, TwistOfEveryLinkIsTheDerivativeOfItsPose) {
  const RobotModel model = modelOf(readUrdf("tilted_chain.urdf"));
  MultibodyWorld world(model, weightless());
  const Eigen::VectorXd q = vectorOf({0.4, -1.1, 2.3});
  const Eigen::VectorXd v = vectorOf({0.7, -1.9, 1.3});
  const double h = 1e-6;
  // Central differences: h^2 times third derivatives of a few units, plus rounding eps / h.
  const double kDifferenceTolerance = 10.0 * (h * h + kEps / h) * 10.0;
  for (const Link& link : model.links) {
    world.reset(q + h * v);
    const Pose X_plus = world.linkPose(link.name);
    world.reset(q - h * v);
    const Pose X_minus = world.linkPose(link.name);
    world.reset(q);
    world.setJointVelocities(v);
    const Pose X = world.linkPose(link.name);
    const Twist V = world.linkTwist(link.name);
    const Eigen::Vector3d linear = X.q.conjugate() * (X_plus.p - X_minus.p) / (2.0 * h);
    const Eigen::AngleAxisd turn(X_minus.q.conjugate() * X_plus.q);
    const Eigen::Vector3d angular = turn.axis() * turn.angle() / (2.0 * h);
    EXPECT_LT((V.head<3>() - linear).norm(), kDifferenceTolerance) << link.name;
    EXPECT_LT((V.tail<3>() - angular).norm(), kDifferenceTolerance) << link.name;
  }
}

/** Largest change of energy of the free tilted chain over a second. */
double energyDrift(double period_s) {
  WorldConfig config;
  config.period_s = period_s;
  MultibodyWorld world(modelOf(readUrdf("tilted_chain.urdf")), config);
  world.reset(vectorOf({0.4, -1.1, 0.3}));
  world.setJointVelocities(vectorOf({0.5, -0.9, 1.3}));
  const double start = world.energy();
  double drift = 0.0;
  while (world.ticks() * period_s < 1.0 - 0.5 * period_s) {
    world.step();
    drift = std::max(drift, std::abs(world.energy() - start));
  }
  return drift;
}

// A first-order method: halving the period halves the error, up to terms of second order.
constexpr double kHalf = 0.5;
constexpr double kSecondOrder = 0.03;

TEST(Dynamics, EnergyOfAFreeChainDriftsHalfAsMuchAtHalfThePeriod) {
  const double coarse = energyDrift(1e-4);
  const double fine = energyDrift(5e-5);
  EXPECT_GT(coarse, 0.0);
  EXPECT_NEAR(fine / coarse, kHalf, kSecondOrder);
}

TEST(Dynamics, EnergyOfAFreeChainIsKeptInTheLimit) {
  // Richardson: what is left of the drift when its first-order part is taken away.
  const double coarse = energyDrift(2e-5);
  const double fine = energyDrift(1e-5);
  MultibodyWorld world(modelOf(readUrdf("tilted_chain.urdf")), WorldConfig{});
  world.reset(vectorOf({0.4, -1.1, 0.3}));
  world.setJointVelocities(vectorOf({0.5, -0.9, 1.3}));
  const double scale = std::abs(world.energy());
  EXPECT_LT(std::abs(2.0 * fine - coarse) / scale, 1e-5);  // second order: (50 rad/s * 2e-5 s)^2 with room for a sum
}

TEST(Dynamics, FreeFallIsExactUpToTheFirstOrderTermOfTheIntegrator) {
  WorldConfig config;
  config.gravity_m_s2 = {kGravity, 0.0, 0.0};
  MultibodyWorld world(sliderModel(), config);
  const int n = 1000;
  world.step(n);
  const double dt = config.period_s;
  // v_k = k g dt exactly; positions sum the velocities at the ends of the steps: g dt^2 n (n + 1) / 2.
  EXPECT_NEAR(world.jointVelocities()[0], n * kGravity * dt, n * 20 * kEps);
  EXPECT_NEAR(world.jointPositions()[0], kGravity * dt * dt * n * (n + 1) / 2.0, n * 20 * kEps);
}

TEST(Dynamics, GravityAcceleratesATiltedCompoundBodyByItsTorqueOverItsInertia) {
  std::string urdf = readUrdf("tilted_chain.urdf");
  urdf = replaced(urdf, "<joint name=\"elbow\" type=\"continuous\">", "<joint name=\"elbow\" type=\"fixed\">");
  urdf = replaced(urdf, "<joint name=\"drawer\" type=\"prismatic\">", "<joint name=\"drawer\" type=\"fixed\">");
  const RobotModel model = modelOf(urdf);
  MultibodyWorld world(model, WorldConfig{});
  const Pose X_WJ = world.linkPose("upper");
  const Eigen::Vector3d axis_W = X_WJ.q * model.movingJoint(0).axis;
  double torque = 0.0;
  for (const Link& link : model.links) {
    const Eigen::Vector3d arm = world.linkPose(link.name) * link.com_m - X_WJ.p;
    torque += axis_W.dot(arm.cross(link.mass_kg * Eigen::Vector3d(0.0, 0.0, -kGravity)));
  }
  const double expected = torque / world.massMatrix()(0, 0);
  world.step();
  EXPECT_NEAR(world.jointVelocities()[0] / 0.001, expected, 1000 * kEps * std::abs(expected) / 0.001 * 0.001 + 1e-12);
}

}  // namespace
}  // namespace aras_visual_servo_sim::dynamics_test
