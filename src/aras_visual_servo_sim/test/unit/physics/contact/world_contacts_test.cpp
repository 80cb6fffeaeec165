// Solids on the ground and on each other: whose friction counts, what is looked at, what placing and resetting leave.
#include <memory>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "aras_visual_servo_sim/physics/contact_config.hpp"
#include "tools/physics_tools.hpp"

namespace aras_visual_servo_sim::world_contacts_test {
namespace {

constexpr double kTilt = 0.3;  // [rad] of the ground, so that what has little friction slides along x
constexpr double kMu = 0.1;

Obstacle boxAt(const std::string& name, double y, double z, double mass_kg) {
  Obstacle box;
  box.name = name;
  box.geometry.size_m = {0.2, 0.2, 0.04};
  box.X_WO.p = {0.0, y, z};
  box.mass_kg = mass_kg;
  return box;
}

WorldConfig tilted(const std::vector<Obstacle>& solids) {
  WorldConfig config;
  config.gravity_m_s2 = kGravity * Eigen::Vector3d(std::sin(kTilt), 0.0, -std::cos(kTilt));
  config.contacts.obstacles = solids;
  config.contacts.friction = 0.8;
  return config;
}

/** Distance after half a second with this friction. The first steps, until the weight is on the springs: dt / t. */
void expectSlid(const MultibodyWorld& world, const std::string& solid, double friction) {
  const double distance = 0.5 * kGravity * (std::sin(kTilt) - friction * std::cos(kTilt)) * 0.25;
  EXPECT_NEAR(world.obstaclePose(solid).p.x() / distance, 1.0, 0.02) << solid;
}

TEST(WorldContacts, OnTheGroundTheSmallerFrictionCountsForEachBody) {
  WorldConfig config = tilted({boxAt("rough", 0.5, 0.02, 0.5), boxAt("smooth", 1.0, 0.02, 0.5)});
  config.contacts.ground = GroundPlane{0.0, 0.8};
  config.contacts.frictions = {{"smooth", kMu}};
  MultibodyWorld world(sliderModel(), config);
  world.step(500);
  EXPECT_LT(std::abs(world.obstaclePose("rough").p.x()), 1e-4);
  expectSlid(world, "smooth", kMu);
}

TEST(WorldContacts, OfAPairTheSmallerFrictionCountsInEitherOrder) {
  for (const bool box_first : {true, false}) {
    for (const char* smooth : {"box", "table"}) {
      SCOPED_TRACE(std::string(smooth) + (box_first ? " first" : ""));
      WorldConfig config = tilted({boxAt("box", 1.0, 0.04, 0.5), boxAt("table", 1.0, 0.0, 0.0)});
      config.contacts.obstacles[1].geometry.size_m.x() = 2.0;
      config.contacts.pairs = {{box_first ? "box" : "table", box_first ? "table" : "box"}};
      config.contacts.frictions = {{smooth, kMu}};
      MultibodyWorld world(sliderModel(), config);
      world.step(500);
      expectSlid(world, "box", kMu);
    }
  }
}

TEST(WorldContacts, ThingsThatStandDoNotTouchEachOther) {
  WorldConfig config = tilted({boxAt("one", 1.0, 0.0, 0.0), boxAt("two", 1.0, 0.01, 0.0)});
  config.contacts.pairs = {{"all", "all"}};
  MultibodyWorld world(sliderModel(), config);
  world.step();
  EXPECT_TRUE(world.contacts().empty());
  config.contacts.pairs = {{"one", "two"}};
  EXPECT_HAS(messageOf<ParameterError>([&] { MultibodyWorld(sliderModel(), config); }), "one of them moving");
}

TEST(WorldContacts, APlacedBodyIsAtRest) {
  WorldConfig config = tilted({boxAt("box", 1.0, 0.5, 0.5)});
  config.contacts.ground = GroundPlane{0.0, 0.8};
  MultibodyWorld world(sliderModel(), config);
  world.step(50);
  EXPECT_GT(world.obstacleTwist("box").norm(), 0.1);
  world.setObstaclePose("box", config.contacts.obstacles[0].X_WO);
  EXPECT_EQ(world.obstacleTwist("box"), Twist::Zero());
}

TEST(WorldContacts, ThingsStayWhereTheyWerePutWhenOthersCome) {
  WorldConfig config = tilted({boxAt("table", 1.0, 0.0, 0.0)});
  config.contacts.ground = GroundPlane{0.0, 0.8};
  MultibodyWorld world(sliderModel(), config);
  Pose moved;
  moved.p = {0.5, 1.5, 0.25};
  world.setObstaclePose("table", moved);
  config.contacts.obstacles.push_back(boxAt("box", 3.0, 0.5, 0.5));
  world.setContacts(config.contacts);
  EXPECT_EQ(world.obstaclePose("table").p, moved.p);
}

TEST(WorldContacts, AResetPutsBodiesBackAtRest) {
  WorldConfig config = tilted({boxAt("box", 1.0, 0.5, 0.5)});
  config.contacts.ground = GroundPlane{0.0, 0.8};
  MultibodyWorld world(sliderModel(), config);
  world.step(50);
  world.reset(world.jointPositions());
  EXPECT_EQ(world.obstaclePose("box").p, config.contacts.obstacles[0].X_WO.p);
  EXPECT_EQ(world.obstacleTwist("box"), Twist::Zero());
}

TEST(WorldContacts, AVelocityThatIsNoNumberIsRefusedByTheNameOfItsBody) {
  WorldConfig config = tilted({boxAt("box", 0.5, 0.5, 0.5), boxAt("needle", 1.0, 0.5, 0.5)});
  config.contacts.obstacles[1].geometry.size_m = {0.2, 1e-170, 1e-170};  // nothing resists its turning about x
  config.contacts.ground = GroundPlane{0.0, 0.8};
  MultibodyWorld world(sliderModel(), config);
  EXPECT_HAS(messageOf<NotFiniteError>([&] { world.step(); }), "solid 'needle': its velocity is not finite");
}

TEST(WorldContacts, EveryNumberOfTheConfigurationIsReadWhereItsNameSays) {
  const ContactConfig config = contactConfigFromYaml(
      YAML::Load("{ground_plane: {z_m: 0.25, friction: 0.3}, pairs: [[a, b], [c, d]], neighbours: true,"
                 " friction: 0.4, stiffness_n_per_m: 5.0, damping_n_s_per_m: 6.0, frictions: {a: 0.7},"
                 " free_bodies: {c: 8.0}}"));
  ASSERT_TRUE(config.ground.has_value());
  EXPECT_EQ(config.ground->z_m, 0.25);
  EXPECT_EQ(config.ground->friction, 0.3);
  const std::vector<std::pair<std::string, std::string>> pairs = {{"a", "b"}, {"c", "d"}};
  EXPECT_EQ(config.pairs, pairs);
  EXPECT_TRUE(config.neighbours);
  EXPECT_EQ(config.friction, 0.4);
  EXPECT_EQ(config.stiffness_n_per_m, 5.0);
  EXPECT_EQ(config.damping_n_s_per_m, 6.0);
  EXPECT_EQ(config.frictions.at("a"), 0.7);
  EXPECT_EQ(config.free_bodies.at("c"), 8.0);
}

TEST(WorldContacts, OneWordStandsForAllPairs) {
  const std::vector<std::pair<std::string, std::string>> pairs = {{"all", "all"}};
  EXPECT_EQ(contactConfigFromYaml(YAML::Load("{pairs: all}")).pairs, pairs);
}

TEST(WorldContacts, APairHasTwoNames) {
  EXPECT_HAS(messageOf<ParameterError>([] { contactConfigFromYaml(YAML::Load("{pairs: [[a, b, c]]}")); }),
             "sim.contacts.pairs[0]: found");
}

}  // namespace
}  // namespace aras_visual_servo_sim::world_contacts_test
