#include "aras_visual_servo_sim/config/errors.hpp"
#include "aras_visual_servo_sim/physics/contact_config.hpp"
#include "tools/physics_tools.hpp"

namespace aras_visual_servo_sim::contact_test {
namespace {

constexpr double kMass = 2.0, kRadius = 0.1, kStiffness = 1e6;

/** sphere.urdf on a ground plane; `shape` instead of the sphere. */
RobotModel body(const std::string& shape = "<sphere radius=\"0.1\"/>") {
  return modelOf(replaced(readUrdf("sphere.urdf"), "<sphere radius=\"0.1\"/>", shape));
}

WorldConfig onTheGround(double friction, double height_m) {
  WorldConfig config;
  config.base = Base::kFloating;
  config.X_WB = Pose{{0.0, 0.0, height_m}, Eigen::Quaterniond::Identity()};
  config.contacts.ground = GroundPlane{0.0, friction};
  return config;
}

/** Gravity of a plane inclined by `angle` about y, seen from the plane. */
Eigen::Vector3d inclined(double angle) { return kGravity * Eigen::Vector3d(std::sin(angle), 0.0, -std::cos(angle)); }

TEST(Contact, ASphereRestsInTheGroundAsDeepAsItsWeightPressesTheSpring) {
  MultibodyWorld world(body(), onTheGround(0.8, 0.3));
  world.step(3000);
  const double depth = kMass * kGravity / kStiffness;
  EXPECT_NEAR(world.basePose().p.z(), kRadius - depth, 1e-6 * depth);
  ASSERT_EQ(world.contacts().size(), 1u);
  const ContactForce contact = world.contacts()[0];
  EXPECT_EQ(contact.a, "ball");
  EXPECT_EQ(contact.b, "ground_plane");
  EXPECT_NEAR(contact.force_W.z(), kMass * kGravity, 1e-6 * kMass * kGravity);
  EXPECT_NEAR(contact.depth_m, depth, 1e-6 * depth);
}

TEST(Contact, ABoxCylinderAndHullRestOnTheirFaces) {
  for (const char* shape : {"<box size=\"0.2 0.3 0.2\"/>", "<cylinder radius=\"0.1\" length=\"0.2\"/>",
                            "<mesh filename=\"cube\" scale=\"0.1 0.1 0.1\"/>"}) {
    WorldConfig config = onTheGround(0.8, 0.15);
    for (int k = 0; k < 8; ++k) {
      config.contacts.mesh_points["cube"].emplace_back(k & 1 ? 1 : -1, k & 2 ? 1 : -1, k & 4 ? 1 : -1);
    }
    MultibodyWorld world(body(shape), config);
    world.step(2000);
    const double depth = kMass * kGravity / kStiffness / 4.0;  // four springs
    EXPECT_NEAR(world.basePose().p.z(), kRadius - depth, 1e-4 * depth) << shape;
    EXPECT_LT(world.basePose().q.angularDistance(Eigen::Quaterniond::Identity()), 1e-6) << shape;
  }
}

/** Distance a box slid down an incline in half a second. */
double slid(double angle, double friction) {
  WorldConfig config = onTheGround(friction, kRadius - 4e-6);
  config.gravity_m_s2 = inclined(angle);
  MultibodyWorld world(body("<box size=\"0.6 0.6 0.2\"/>"), config);
  world.step(500);
  return world.basePose().p.x();
}

TEST(Contact, ABoxHoldsOnAnInclineUpToTheConeAndSlidesBeyondItAsTheConeSays) {
  const double friction = 0.5;
  const double threshold = std::atan(friction);
  EXPECT_LT(std::abs(slid(threshold - 0.002, friction)), 1e-5);
  EXPECT_GT(slid(threshold + 0.002, friction), 1e-4);
  const double angle = threshold + 0.2;
  const double acceleration = kGravity * (std::sin(angle) - friction * std::cos(angle));
  // Half a second of it; the first steps, until the weight is on the springs, and the sum over steps: dt / t.
  EXPECT_NEAR(slid(angle, friction) / (0.5 * acceleration * 0.25), 1.0, 0.01);
}

TEST(Contact, ASphereRollsDownAnInclineWithoutSlipping) {
  WorldConfig config = onTheGround(0.8, kRadius - 1e-5);
  const double angle = 0.3;
  config.gravity_m_s2 = inclined(angle);
  MultibodyWorld world(body(), config);
  world.step(1000);
  // Of m g sin(angle), 1 / (1 + I / (m r^2)) accelerates: 5 / 7 of it.
  const double expected = 0.5 * kGravity * std::sin(angle) / (1.0 + 0.008 / (kMass * kRadius * kRadius));
  EXPECT_NEAR(world.basePose().p.x() / expected, 1.0, 0.01);
}

/** The arm of the tests above a table, its lowest link with a ball of a hand. */
WorldConfig sliderAgainst(const Geometry& wall, double x_m) {
  WorldConfig config = weightless();
  config.controllers = {
      controllerOf("slide", ControllerType::kEffortPosition, PidGains{5000.0, 0.0, 300.0, 0.0, 0.0, false})};
  config.contacts.pairs = {{"robot", "wall"}};
  config.contacts.obstacles = {{"wall", wall, Pose{{x_m, 0.0, 0.0}, Eigen::Quaterniond::Identity()}, 0.0}};
  return config;
}

RobotModel sliderWithBall() {
  return modelOf(replaced(readUrdf("slider.urdf"), "</inertial>",
                          "</inertial><collision><geometry><sphere radius=\"0.05\"/></geometry></collision>"));
}

Geometry boxOf(double x, double y, double z) {
  Geometry geometry;
  geometry.size_m = {x, y, z};
  return geometry;
}

TEST(Contact, AStiffDriveIsStoppedByAWallWithItsForceInBalance) {
  MultibodyWorld world(sliderWithBall(), sliderAgainst(boxOf(0.2, 1.0, 1.0), 0.4));
  world.setPosition("slide", 0.4);
  world.step(3000);
  // 5000 (0.4 - x) = 1e6 (x - 0.25)
  const double x = (5000.0 * 0.4 + kStiffness * 0.25) / (5000.0 + kStiffness);
  EXPECT_NEAR(world.jointPositions()[0], x, 1e-7);
  ASSERT_EQ(world.contacts().size(), 1u);
  EXPECT_NEAR(world.contacts()[0].force_W.x(), -5000.0 * (0.4 - x), 1e-3);
  EXPECT_NEAR(world.jointEfforts()[0], 5000.0 * (0.4 - x), 1e-3);
}

TEST(Contact, AFreeBodyIsPushedAlongAndComesToRestByFriction) {
  WorldConfig config = sliderAgainst(boxOf(0.1, 0.1, 0.1), 0.2);
  config.gravity_m_s2 = {0.0, 0.0, -kGravity};
  config.contacts.ground = GroundPlane{-0.05, 0.4};
  config.contacts.free_bodies = {{"wall", 0.5}};
  config.contacts.pairs = {{"block", "wall"}};
  MultibodyWorld world(modelOf(replaced(readUrdf("slider.urdf"), "</inertial>",
                                        "</inertial><collision><geometry><box size=\"0.1 0.1 0.08\"/></geometry>"
                                        "</collision>")),
                       config);
  world.setPosition("slide", 0.3);
  world.step(4000);
  const Pose X = world.obstaclePose("wall");
  EXPECT_GT(X.p.x(), 0.39);
  EXPECT_NEAR(X.p.z(), -0.5 * kGravity / kStiffness / 4.0, 1e-6);
  world.step(100);
  EXPECT_LT((world.obstaclePose("wall").p - X.p).norm(), 1e-9);  // at rest
}

TEST(Contact, TwoRunsAndARestoredOneGiveTheSameBytes) {
  const auto make = [] {
    WorldConfig config = onTheGround(0.6, 0.2);
    config.X_WB->q = quaternionFromRpy({0.3, 0.5, 0.1});
    return std::make_unique<MultibodyWorld>(body("<box size=\"0.2 0.3 0.15\"/>"), config);
  };
  const auto one = make(), other = make();
  one->step(400);
  other->step(250);
  const std::string state = other->saveState();
  other->step(300);
  other->restoreState(state);
  other->step(150);
  EXPECT_EQ(one->saveState(), other->saveState());
}

TEST(Contact, AdjacentLinksNeverTouchAndNothingDoesUnlessAsked) {
  const std::string ball = "</inertial><collision><geometry><sphere radius=\"0.4\"/></geometry></collision>";
  std::string urdf = readUrdf("tilted_chain.urdf");
  for (std::size_t at = 0; (at = urdf.find("</inertial>", at)) != std::string::npos; at += ball.size()) {
    urdf.replace(at, 11, ball);
  }
  WorldConfig plain;
  WorldConfig self = plain;
  self.contacts.pairs = {{"robot", "robot"}};
  MultibodyWorld without(modelOf(urdf), plain), with(modelOf(urdf), self);
  without.step(50);
  with.step(50);
  EXPECT_TRUE(without.contacts().empty());
  for (const ContactForce& contact : with.contacts()) {
    EXPECT_FALSE((contact.a == "upper" && contact.b == "box") || (contact.a == "box" && contact.b == "upper"));
  }
  self.contacts.pairs = {{"upper", "box"}};
  EXPECT_HAS(messageOf<ParameterError>([&] { MultibodyWorld(modelOf(urdf), self); }),
             "sim/contacts/pairs: found [upper, box], must be two with a shape each");
  self.contacts.pairs = {{"robot", "table"}};
  EXPECT_HAS(messageOf<ParameterError>([&] { MultibodyWorld(modelOf(urdf), self); }),
             "sim/contacts/pairs: found table, allowed names with a shape: `robot`");
}

TEST(Contact, ConfigurationFaultsAreListed) {
  const std::string text = messageOf<ParameterError>([] {
    contactConfigFromYaml(
        YAML::Load("{ground_plane: {friction: -1, depth: 2}, pairs: [[a], b], stiffness_n_per_m: 0,"
                   " free_bodies: {cube: heavy}}"));
  });
  EXPECT_HAS(text, "sim.contacts.ground_plane.friction: found -1, allowed >= 0");
  EXPECT_HAS(text, "sim.contacts.ground_plane.depth: found an unknown key");
  EXPECT_HAS(text, "sim.contacts.pairs[0]: found");
  EXPECT_HAS(text, "sim.contacts.pairs[1]: found");
  EXPECT_HAS(text, "sim.contacts.stiffness_n_per_m: found 0, allowed > 0");
  EXPECT_HAS(text, "sim.contacts.free_bodies.cube: found heavy, allowed a number");
}

}  // namespace
}  // namespace aras_visual_servo_sim::contact_test
