#include "physics/body/driven_base.hpp"

#include "aras_visual_servo_sim/config/errors.hpp"
#include "tools/physics_tools.hpp"

namespace aras_visual_servo_sim::driven_base_test {
namespace {

constexpr double kEps = 2.2e-16;
/** Of a thousand steps, each of which rounds a few numbers of order one. */
constexpr double kThousandSteps = 1000 * 8 * kEps;
constexpr int kSteps = 1000;

WorldConfig driven(double timeout_s = 0.0) {
  WorldConfig config;  // with gravity: nothing falls
  config.base = Base::kDriven;
  config.command_timeout_s = timeout_s;
  config.X_WB = Pose{{0.3, -0.2, 1.1}, quaternionFromRpy({0.4, -0.7, 1.2})};
  return config;
}

MultibodyWorld worldOf(const WorldConfig& config = driven()) {
  return MultibodyWorld(modelOf(readUrdf("driven_camera.urdf")), config);
}

JointCommand velocities(const Twist& V) {
  JointCommand command;
  for (int k = 0; k < 6; ++k) command.velocity[DrivenBase::coordinates()[k]] = V[k];
  return command;
}

Twist twistOf(double vx, double vy, double vz, double wx, double wy, double wz) {
  return (Twist() << vx, vy, vz, wx, wy, wz).finished();
}

void expectNear(const Pose& found, const Pose& expected, double tolerance) {
  EXPECT_LT((found.matrix() - expected.matrix()).cwiseAbs().maxCoeff(), tolerance) << found.matrix() << "\nexpected\n"
                                                                                   << expected.matrix();
}

TEST(DrivenBase, HeldTwistIsAScrewWhateverTheNumberOfSteps) {
  auto world = worldOf();
  const Pose start = world.basePose();
  const Twist V = twistOf(0.1, -0.2, 0.3, 0.7, -1.9, 2.4);
  world.setCommand(velocities(V));
  world.step(kSteps);
  expectNear(world.basePose(), start * exponential(V), kThousandSteps);
  EXPECT_EQ(world.jointVelocities(), Eigen::VectorXd(V));
}

TEST(DrivenBase, ExponentialSolvesItsDifferentialEquation) {
  const Twist V = twistOf(0.4, -0.1, 0.2, 1.3, 0.8, -2.1);
  constexpr double kStep = 1e-5;
  const Eigen::Matrix4d slope =
      (exponential((1.0 + kStep) * V).matrix() - exponential((1.0 - kStep) * V).matrix()) / (2.0 * kStep);
  Eigen::Matrix4d hat = Eigen::Matrix4d::Zero();
  hat << 0.0, -V[5], V[4], V[0], V[5], 0.0, -V[3], V[1], -V[4], V[3], 0.0, V[2], 0.0, 0.0, 0.0, 0.0;
  // Central differences: h^2 times the third derivative, |w|^3 = 18.
  EXPECT_LT((slope - exponential(V).matrix() * hat).cwiseAbs().maxCoeff(), 20.0 * kStep * kStep);
}

TEST(DrivenBase, HalfATurnAboutAnyAxisIsATurnAsAnyOther) {
  for (const Eigen::Vector3d& axis :
       {Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(0, 1, 0), Eigen::Vector3d(0, 0, 1), Eigen::Vector3d(0.6, 0, -0.8)}) {
    auto world = worldOf();
    const Pose start = world.basePose();
    world.setCommand(velocities(twistOf(0, 0, 0, kPi * axis.x(), kPi * axis.y(), kPi * axis.z())));
    for (int half = 1; half <= 3; ++half) {  // beyond a whole turn too
      world.step(kSteps);
      const Pose turn{Eigen::Vector3d::Zero(), Eigen::Quaterniond(Eigen::AngleAxisd(half * kPi, axis))};
      expectNear(world.basePose(), start * turn, 3 * kThousandSteps);
      EXPECT_LE(world.jointPositions().tail<3>().norm(), kPi * (1.0 + kEps));
    }
  }
}

TEST(DrivenBase, CoordinatesPlaceItAndSayWhereItIs) {
  auto world = worldOf();
  for (const double angle : {0.0, 1e-9, 0.3, 2.0, 3.14159, kPi}) {
    const Eigen::Vector3d r = angle * Eigen::Vector3d(2.0, -3.0, 6.0) / 7.0;
    world.setJointPositions({{"px", 0.1}, {"py", -0.2}, {"pz", 0.3}, {"rx", r.x()}, {"ry", r.y()}, {"rz", r.z()}});
    const Pose expected{{0.1, -0.2, 0.3}, Eigen::Quaterniond(Eigen::AngleAxisd(angle, r.stableNormalized()))};
    if (angle > 0.0) expectNear(world.basePose(), expected, 20 * kEps);
    const Eigen::Vector3d found = world.jointPositions().tail<3>();
    // Of half a turn, rounding decides between the two vectors that stand for it.
    EXPECT_LT(std::min((found - r).norm(), angle > 3.0 ? (found + r).norm() : 1.0), 20 * kEps) << angle;
    EXPECT_EQ(world.jointVelocities().norm(), 0.0);
  }
}

TEST(DrivenBase, PlacingOnlyItsPositionKeepsEveryBitOfItsAttitude) {
  auto world = worldOf();
  const Eigen::Vector4d before = world.basePose().q.coeffs();
  world.setJointPositions({{"py", 0.5}});
  EXPECT_EQ(world.basePose().q.coeffs(), before);
  EXPECT_EQ(world.basePose().p.y(), 0.5);
}

TEST(DrivenBase, PositionAndVelocityOfOneCommandActTogether) {
  auto world = worldOf();
  world.setCommand(velocities(twistOf(1, 1, 1, 1, 1, 1)));
  world.step();
  world.setCommand(JointCommand{{{"px", 2.0}}, {{"px", 0.5}}, {}});
  EXPECT_EQ(world.basePose().p.x(), 2.0);
  world.step();
  EXPECT_EQ(world.jointVelocities(), Eigen::VectorXd(twistOf(0.5, 0, 0, 0, 0, 0)));  // placing brought it to rest
}

TEST(DrivenBase, StopsAtOnceAndWhenTheCommandIsTooOld) {
  auto world = worldOf(driven(0.1));
  world.setCommand(velocities(twistOf(1, 0, 0, 0, 0, 0)));
  const Pose start = world.basePose();
  world.step(200);
  EXPECT_NEAR((world.basePose().p - start.p).norm(), 0.1, kThousandSteps);
  EXPECT_EQ(world.jointVelocities().norm(), 0.0);
  world.setCommand(velocities(twistOf(1, 0, 0, 0, 0, 0)));
  world.step();
  world.hold();
  const Eigen::Vector3d there = world.basePose().p;
  world.step(50);
  EXPECT_EQ(world.basePose().p, there);
}

TEST(DrivenBase, TwistOfACarriedLinkMovesThatLink) {
  auto world = worldOf();
  const Twist V = twistOf(0.2, -0.1, 0.3, 0.5, -0.4, 0.9);
  const Pose before = world.linkPose("eye_optical_frame");
  world.setCommand(world.twistCommand(V, "eye_optical_frame"));
  world.step(kSteps);
  expectNear(world.linkPose("eye_optical_frame"), before * exponential(V), kThousandSteps);
  EXPECT_LT((world.linkTwist("eye_optical_frame") - V).norm(), 50 * kEps);
  EXPECT_THROW(world.twistCommand(V, "world"), ParameterError);
  EXPECT_THROW(world.twistCommand(V, "elbow"), UnknownNameError);
}

TEST(DrivenBase, SavedStateGoesOnWithTheSameBytes) {
  auto world = worldOf(driven(0.5));
  world.setCommand(velocities(twistOf(0.3, 0.2, 0.1, 2.0, -1.0, 0.5)));
  world.step(100);
  const std::string state = world.saveState();
  world.step(900);
  const std::string end = world.saveState();
  auto other = worldOf(driven(0.5));
  other.restoreState(state);
  other.step(900);
  EXPECT_EQ(other.saveState(), end);
  MultibodyWorld arm(modelOf(readUrdf("pendulum.urdf")), WorldConfig());
  EXPECT_THROW(arm.restoreState(state), StateError);
}

TEST(DrivenBase, ResetPutsItBackToTheBit) {
  auto world = worldOf();
  world.reset(vectorOf({0.1, 0.2, 0.3, 1.0, -2.0, 0.5}));
  const std::string start = world.saveState();
  world.setCommand(velocities(twistOf(1, 2, 3, 4, 5, 6)));
  world.step(77);
  world.reset(vectorOf({0.1, 0.2, 0.3, 1.0, -2.0, 0.5}));
  EXPECT_EQ(world.saveState(), start);
}

TEST(DrivenBase, RefusesWhatItCannotDo) {
  auto world = worldOf();
  const auto command = [](const std::string& name, double value) { return JointCommand{{}, {{name, value}}, {}}; };
  EXPECT_THROW(world.setCommand(command("J1", 0.1)), UnknownNameError);
  EXPECT_THROW(world.setCommand(command("rx", std::nan(""))), NotFiniteError);
  EXPECT_THROW(world.setEffort("px", 1.0), ParameterError);
  EXPECT_THROW(world.setBaseTwist(Twist::Zero()), ParameterError);
  EXPECT_THROW(world.setJointPositions({{"px", std::nan("")}}), NotFiniteError);
  EXPECT_THROW(world.reset(vectorOf({0.0})), ShapeError);
  EXPECT_THROW(MultibodyWorld(modelOf(readUrdf("pendulum.urdf")), driven()), ParameterError);
  WorldConfig touching = driven();
  touching.contacts.ground = GroundPlane{0.0, 0.5};
  EXPECT_THROW(worldOf(touching), ParameterError);
  MultibodyWorld arm(modelOf(readUrdf("pendulum.urdf")), WorldConfig());
  EXPECT_THROW(arm.twistCommand(Twist::Zero(), ""), ParameterError);
}

}  // namespace
}  // namespace aras_visual_servo_sim::driven_base_test
