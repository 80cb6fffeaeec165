#include "aras_visual_servo_sim/config/errors.hpp"
#include "tools/physics_tools.hpp"

namespace aras_visual_servo_sim::floating_base_test {
namespace {

constexpr double kEps = 2.2e-16;

/** tilted_chain.urdf whose root has mass. */
std::string chain() {
  return replaced(readUrdf("tilted_chain.urdf"), "<link name=\"world\"/>",
                  "<link name=\"world\"><inertial><origin xyz=\"0.04 -0.02 0.06\" rpy=\"0.1 0.5 -0.2\"/>"
                  "<mass value=\"3.1\"/><inertia ixx=\"0.11\" iyy=\"0.08\" izz=\"0.06\" ixy=\"0.01\" ixz=\"-0.012\" "
                  "iyz=\"0.02\"/></inertial></link>");
}

Pose tilted() { return {{0.3, -0.2, 1.1}, quaternionFromRpy({0.4, -0.7, 1.2})}; }

WorldConfig floating(double period_s = 0.001) {
  WorldConfig config = weightless(period_s);
  config.base = Base::kFloating;
  config.X_WB = tilted();
  return config;
}

void setMoving(MultibodyWorld& world) {
  world.reset(vectorOf({0.4, -1.1, 2.3}));
  world.setJointVelocities(vectorOf({0.7, -1.9, 1.3}));
  Twist V;
  V << 0.3, -0.4, 0.2, 0.8, -0.5, 0.6;
  world.setBaseTwist(V);
}

/** Linear momentum, angular momentum about the world origin, kinetic energy, link by link. */
struct Motion {
  Eigen::Vector3d P = Eigen::Vector3d::Zero(), L = Eigen::Vector3d::Zero();
  double energy = 0.0;
};

Motion motionOf(const MultibodyWorld& world) {
  Motion motion;
  for (const Link& link : world.model().links) {
    const Pose X = world.linkPose(link.name);
    const Twist V = world.linkTwist(link.name);
    const Eigen::Vector3d omega = V.tail<3>();
    const Eigen::Vector3d velocity = V.head<3>() + omega.cross(link.com_m);
    const Eigen::Vector3d p = X.q * (link.mass_kg * velocity);
    motion.P += p;
    motion.L += (X * link.com_m).cross(p) + X.q * (link.inertia_kg_m2 * omega);
    motion.energy += 0.5 * velocity.dot(link.mass_kg * velocity) + 0.5 * omega.dot(link.inertia_kg_m2 * omega);
  }
  return motion;
}

TEST(FloatingBase, KineticEnergyIsTheSumOverTheLinks) {
  MultibodyWorld world(modelOf(chain()), floating());
  setMoving(world);
  const double expected = motionOf(world).energy;
  EXPECT_NEAR(world.energy(), expected, 1000 * kEps * expected);
}

TEST(FloatingBase, TwistOfEveryLinkIsTheDerivativeOfItsPose) {
  const double h = 1e-6;
  MultibodyWorld before(modelOf(chain()), floating(h)), after(modelOf(chain()), floating(h));
  setMoving(before);
  setMoving(after);
  after.step();
  for (const Link& link : before.model().links) {
    const Pose X = before.linkPose(link.name);
    const Eigen::Vector3d v = X.q.conjugate() * (after.linkPose(link.name).p - X.p) / h;
    // One-sided: h times accelerations up to some tens.
    EXPECT_LT((v - before.linkTwist(link.name).head<3>()).norm(), 100.0 * h) << link.name;
    const Eigen::AngleAxisd turn(X.q.conjugate() * after.linkPose(link.name).q);
    EXPECT_LT((turn.angle() * turn.axis() / h - before.linkTwist(link.name).tail<3>()).norm(), 100.0 * h) << link.name;
  }
}

/** Change of momentum and energy in 0.4 s of free tumbling. */
Motion drift(double period_s) {
  MultibodyWorld world(modelOf(chain()), floating(period_s));
  setMoving(world);
  const Motion before = motionOf(world);
  world.step(static_cast<int>(std::lround(0.4 / period_s)));
  const Motion after = motionOf(world);
  return {after.P - before.P, after.L - before.L, after.energy - before.energy};
}

TEST(FloatingBase, MomentumAndEnergyOfAFreeRobotAreKeptToFirstOrderInThePeriod) {
  const Motion coarse = drift(2e-4);
  const Motion fine = drift(1e-4);
  EXPECT_LT(coarse.P.norm(), 2e-3);
  EXPECT_LT(coarse.L.norm(), 5e-3);
  EXPECT_LT(std::abs(coarse.energy), 1e-2);
  // Halved with the period, the second order left over; there is something to halve.
  EXPECT_GT(coarse.L.norm(), 1e-6);
  EXPECT_NEAR(fine.P.norm() / coarse.P.norm(), 0.5, 0.05);
  EXPECT_NEAR(fine.L.norm() / coarse.L.norm(), 0.5, 0.05);
  EXPECT_NEAR(fine.energy / coarse.energy, 0.5, 0.05);
}

TEST(FloatingBase, FallsAsAPointMassAndDrivesDoNotMoveItsCentreOfMass) {
  WorldConfig config = floating();
  config.gravity_m_s2 = {0.0, 0.0, -kGravity};
  config.controllers = {
      controllerOf("shoulder", ControllerType::kEffortPosition, PidGains{80.0, 0.0, 5.0, 0.0, 0.0, false})};
  MultibodyWorld world(modelOf(chain()), config);
  world.setPosition("shoulder", 0.5);
  double mass = 0.0;
  for (const Link& link : world.model().links) mass += link.mass_kg;
  world.step(300);
  // Of sums of momenta of some 10 kg m/s moved back and forth by the drive, to first order in the period.
  EXPECT_NEAR(motionOf(world).P.z() / mass, -kGravity * 0.3, 0.02);
  EXPECT_NEAR(motionOf(world).P.x() / mass, 0.0, 0.02);
  EXPECT_GT(std::abs(world.jointPositions()[2]), 0.1);  // the shoulder went
}

TEST(FloatingBase, StateIsSavedAndRestoredToTheBit) {
  MultibodyWorld world(modelOf(chain()), floating());
  setMoving(world);
  world.step(50);
  const std::string state = world.saveState();
  world.step(100);
  const Pose expected = world.basePose();
  world.restoreState(state);
  world.step(100);
  EXPECT_EQ(world.basePose().p, expected.p);
  EXPECT_EQ(world.basePose().q.coeffs(), expected.q.coeffs());
  EXPECT_THROW(MultibodyWorld(modelOf(chain()), weightless()).restoreState(state), StateError);
}

std::string withFloatingJoint() {
  return replaced(chain(), "<link name=\"world\">",
                  "<link name=\"ground\"/><joint name=\"free\" type=\"floating\"><parent link=\"ground\"/>"
                  "<child link=\"world\"/><origin xyz=\"1 2 3\"/></joint><link name=\"world\">");
}

TEST(FloatingBase, AFloatingJointOfTheRootMeansOne) {
  WorldConfig config;
  MultibodyWorld world(modelOf(withFloatingJoint()), config);
  EXPECT_TRUE(world.floatingBase());
  EXPECT_EQ(world.basePose().p, Eigen::Vector3d(1, 2, 3));
  world.step(100);
  EXPECT_LT(world.linkPose("world").p.z(), 3.0);
  EXPECT_EQ(world.linkPose("ground").p, Eigen::Vector3d::Zero());
  EXPECT_EQ(world.model().joint_names.size(), 3u);
  config.base = Base::kFixed;
  MultibodyWorld held(modelOf(withFloatingJoint()), config);
  held.step(100);
  EXPECT_EQ(held.linkPose("world").p, Eigen::Vector3d(1, 2, 3));
}

TEST(FloatingBase, OfAFixedOneThePoseIsChosen) {
  WorldConfig config;
  config.X_WB = tilted();
  const RobotModel model = modelOf(readUrdf("tilted_chain.urdf"));
  MultibodyWorld world(model, config), plain(model, WorldConfig{});
  for (const Link& link : model.links) {
    const Pose expected = tilted() * plain.linkPose(link.name);
    EXPECT_LT((world.linkPose(link.name).p - expected.p).norm(), 20 * kEps) << link.name;
    EXPECT_LT(world.linkPose(link.name).q.angularDistance(expected.q), 1e-7) << link.name;  // acos near 1
  }
  EXPECT_HAS(messageOf<ParameterError>([&] { world.setBasePose(tilted()); }), "the base is fixed");
}

TEST(FloatingBase, WhatCannotFloatIsRefused) {
  WorldConfig config;
  config.base = Base::kFloating;
  EXPECT_HAS(messageOf<ModelError>([&] { MultibodyWorld(modelOf(readUrdf("tilted_chain.urdf")), config); }),
             "link 'world': is a floating base of mass 0");
  EXPECT_HAS(messageOf<ModelError>(
                 [&] { modelOf(replaced(chain(), "\"elbow\" type=\"continuous\"", "\"elbow\" type=\"floating\"")); }),
             "joint 'elbow': type is 'floating' below the root link 'world', must be the root's one joint");
  EXPECT_HAS(messageOf<ModelError>([&] {
               modelOf(replaced(withFloatingJoint(), "</robot>",
                                "<link name=\"post\"/><joint name=\"p\" type=\"fixed\"><parent link=\"ground\"/>"
                                "<child link=\"post\"/></joint></robot>"));
             }),
             "joint 'free': type is 'floating', but the root link 'ground' carries 2 joints");
}

}  // namespace
}  // namespace aras_visual_servo_sim::floating_base_test
