// Contacts against what can be worked out by hand.
#include <memory>

#include "tools/physics_tools.hpp"

namespace aras_visual_servo_sim::contact_analytic_test {
namespace {

constexpr double kMass = 0.5, kEdge = 0.1, kStiffness = 1e6, kFriction = 0.5;

Obstacle boxAt(const std::string& name, const Eigen::Vector3d& p) {
  Obstacle box;
  box.name = name;
  box.geometry.size_m.setConstant(kEdge);
  box.X_WO = Pose{p, Eigen::Quaterniond::Identity()};
  box.mass_kg = kMass;
  return box;
}

Geometry cylinderOf(double radius, double length) {
  Geometry geometry;
  geometry.type = Geometry::Type::kCylinder;
  geometry.radius_m = radius;
  geometry.length_m = length;
  return geometry;
}

/** Corners of the box of edge kEdge. */
void addCube(WorldConfig& config) {
  for (int k = 0; k < 8; ++k) {
    config.contacts.mesh_points["cube"].emplace_back(0.5 * kEdge *
                                                     Eigen::Vector3d(k & 1 ? 1 : -1, k & 2 ? 1 : -1, k & 4 ? 1 : -1));
  }
}

std::unique_ptr<MultibodyWorld> worldOf(const WorldConfig& config) {
  return std::make_unique<MultibodyWorld>(sliderModel(), config);
}

/** Boxes on each other, exactly aligned: the faces cut each other in edges that lie on each other. */
TEST(ContactAnalytic, AStackStandsStillWithTheWeightAboveOnEveryFace) {
  constexpr int kHigh = 3;
  WorldConfig config;
  config.contacts.ground = GroundPlane{0.0, kFriction};
  config.contacts.pairs = {{"all", "all"}};
  for (int k = 0; k < kHigh; ++k) {
    config.contacts.obstacles.push_back(boxAt("box" + std::to_string(k), {0.0, 1.0, (0.5 + k) * kEdge}));
  }
  const auto world = worldOf(config);
  world->step(15000);
  double height = 0.0;
  for (int k = 0; k < kHigh; ++k) {
    height -= (kHigh - k) * kMass * kGravity / (4.0 * kStiffness);  // four corners of the face
    const Pose X = world->obstaclePose("box" + std::to_string(k));
    // Settled to the rounding of what the depths come from, a position of 0.3 m: 1e-16 over 2e-6.
    EXPECT_NEAR(X.p.z(), (0.5 + k) * kEdge + height, 1e-13);
    EXPECT_LT(std::hypot(X.p.x(), X.p.y() - 1.0), 1e-12);
    EXPECT_LT(X.q.vec().norm(), 1e-12);
  }
  double between = 0.0;
  int points = 0;
  for (const ContactForce& contact : world->contacts()) {
    if (contact.a == "ground_plane" || contact.b == "ground_plane") continue;
    const bool top = contact.a == "box2" || contact.b == "box2";
    between += top ? contact.force_W.z() : 0.0;
    points += top;
  }
  EXPECT_EQ(points, 4);
  EXPECT_NEAR(std::abs(between), kMass * kGravity, 1e-8 * kMass * kGravity);
}

TEST(ContactAnalytic, BoxesHullsAndCylindersStandOnEachOther) {
  Geometry box = boxAt("", Eigen::Vector3d::Zero()).geometry;
  Geometry hull;
  hull.type = Geometry::Type::kMesh;
  hull.filename = "cube";
  const Geometry can = cylinderOf(0.05, kEdge);
  for (const Geometry& below : {box, hull}) {
    for (const Geometry& above : {box, hull, can}) {
      WorldConfig config;
      addCube(config);
      config.contacts.pairs = {{"all", "all"}};
      Obstacle table = boxAt("table", {0.0, 1.0, 0.0});
      table.geometry = below;
      table.mass_kg = 0.0;
      Obstacle thing = boxAt("thing", {0.02, 1.01, kEdge});
      thing.geometry = above;
      thing.X_WO.q = quaternionFromRpy({0.0, 0.0, 0.3});
      config.contacts.obstacles = {table, thing};
      const auto world = worldOf(config);
      world->step(1000);
      const Pose rest = world->obstaclePose("thing");
      // Two boxes: depths of a few micrometres. Round things: Bullet's search turns them to find more than one point.
      EXPECT_NEAR(rest.p.z(), kEdge, above.type == Geometry::Type::kCylinder ? 1e-4 : 1e-5);
      EXPECT_NEAR(rest.q.angularDistance(thing.X_WO.q), 0.0, 1e-4);
      world->step(2000);
      EXPECT_LT((world->obstaclePose("thing").p - rest.p).norm(), 1e-5);
    }
  }
}

TEST(ContactAnalytic, ABoxHeldOnAnInclineDoesNotCreep) {
  WorldConfig config;
  const double angle = std::atan(kFriction) - 0.01;
  config.gravity_m_s2 = kGravity * Eigen::Vector3d(std::sin(angle), 0.0, -std::cos(angle));
  config.contacts.ground = GroundPlane{0.0, kFriction};
  config.contacts.obstacles = {boxAt("box", {0.0, 1.0, 0.5 * kEdge})};
  config.contacts.obstacles[0].geometry.size_m.z() = 0.04;  // flat, so that it does not topple
  config.contacts.obstacles[0].X_WO.p.z() = 0.02;
  const auto world = worldOf(config);
  world->step(1000);
  const Eigen::Vector3d rest = world->obstaclePose("box").p;
  world->step(10000);
  // Newton's steps leave 1e-7 of a step's fall, m g dt, at each image of it, and sweeps take that away again.
  EXPECT_LT((world->obstaclePose("box").p - rest).norm(), 1e-9);
}

/** m v' = -mu m g, I w' = mu m g r until v = w r: after t = 2 v0 / (7 mu g), at 5/7 v0. */
TEST(ContactAnalytic, AThrownBallSlidesUntilItRolls) {
  constexpr double kSpeed = 1.0, kRadius = 0.1;
  WorldConfig config;
  config.base = Base::kFloating;
  config.X_WB = Pose{{0.0, 0.0, kRadius - 2.0 * kGravity / kStiffness}, Eigen::Quaterniond::Identity()};
  config.contacts.ground = GroundPlane{0.0, kFriction};
  MultibodyWorld world(modelOf(readUrdf("sphere.urdf")), config);
  world.setBaseTwist((Twist() << kSpeed, 0.0, 0.0, 0.0, 0.0, 0.0).finished());
  const double rolls_s = 2.0 * kSpeed / (7.0 * kFriction * kGravity);
  world.step(static_cast<int>(0.5 * rolls_s * 1000.0));
  const double t = 0.001 * static_cast<double>(world.ticks());
  const auto speed = [&] { return (world.basePose().q * world.linkTwist("ball").head<3>()).x(); };
  EXPECT_NEAR(speed(), kSpeed - kFriction * kGravity * t, 2e-3);  // the first steps, until the spring carries all
  world.step(200);
  EXPECT_NEAR(speed(), 5.0 / 7.0 * kSpeed, 1e-3);
}

/** Spring and damper, backward Euler: a half period costs exp(-pi (zeta + omega dt / 2)) of the speed. */
TEST(ContactAnalytic, ABallBouncesAsHighAsSpringDamperAndStepLeaveIt) {
  constexpr double kBall = 2.0, kRadius = 0.1, kSoft = 1e4, kDrop = 0.1;
  for (const double damping : {0.0, 20.0, 60.0}) {
    WorldConfig config;
    config.base = Base::kFloating;
    config.X_WB = Pose{{0.0, 0.0, kRadius + kDrop}, Eigen::Quaterniond::Identity()};
    config.contacts.ground = GroundPlane{0.0, kFriction};
    config.contacts.stiffness_n_per_m = kSoft;
    config.contacts.damping_n_s_per_m = damping;
    MultibodyWorld world(modelOf(readUrdf("sphere.urdf")), config);
    while (world.contacts().empty() && world.ticks() < 1000) world.step();
    while (!world.contacts().empty() && world.ticks() < 1000) world.step();
    double highest = 0.0;
    for (int k = 0; k < 300; ++k) {
      world.step();
      highest = std::max(highest, world.basePose().p.z() - kRadius);
    }
    const double omega = std::sqrt(kSoft / kBall);
    const double zeta = damping / (2.0 * std::sqrt(kSoft * kBall));
    const double restitution = std::exp(-kPi * (zeta + 0.5 * omega * config.period_s));
    EXPECT_NEAR(std::sqrt(highest / kDrop), restitution, 0.03) << damping;  // weight and the end of touch left out
  }
}

}  // namespace
}  // namespace aras_visual_servo_sim::contact_analytic_test
