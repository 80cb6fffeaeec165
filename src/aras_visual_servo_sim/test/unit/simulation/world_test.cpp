#include "aras_visual_servo_sim/simulation/world.hpp"

#include "tools/pan_lift.hpp"
#include "tools/physics_tools.hpp"

namespace aras_visual_servo_sim::world_test {
namespace {

const char kBox[] =
    "<robot name='box'><link name='body'><inertial><mass value='2'/><inertia ixx='0.02' iyy='0.02' izz='0.02' ixy='0' "
    "ixz='0' iyz='0'/></inertial><visual><geometry><box size='0.2 0.2 0.2'/></geometry></visual><collision><geometry>"
    "<box size='0.2 0.2 0.2'/></geometry></collision></link></robot>";
const char kFree[] = "base: floating, contacts: {neighbours: true}";

SimulationConfig configOf(const std::string& text) { return SimulationConfig::fromYaml(YAML::Load("{" + text + "}")); }

std::string at(double x, double z) {
  return ", base_pose: {position_m: [" + std::to_string(x) + ", 0, " + std::to_string(z) + "], rpy_rad: [0, 0, 0]}";
}

std::shared_ptr<Robot> spawnBox(World& world, const std::string& name, double x, double z,
                                const std::string& config = kFree) {
  return world.spawn(name, modelOf(kBox), configOf(config + at(x, z)));
}

SimulationConfig panLiftConfig() {
  YAML::Node sim = YAML::LoadFile(fixture::file("sim.yaml"))["sim"];
  sim.remove("scene");
  return SimulationConfig::fromYaml(sim);
}

std::shared_ptr<Robot> spawnPanLift(World& world, const std::string& name) {
  return world.spawn(name, loadRobotModelFile(fixture::file("pan_lift.urdf")), panLiftConfig(),
                     YAML::LoadFile(fixture::file("controllers.yaml")));
}

double heightOf(const Robot& robot) { return robot.body().basePose().p.z(); }

TEST(World, RobotsThatTouchNothingMoveAsAlone) {
  World world(configOf(""));
  const auto left = spawnPanLift(world, "left"), right = spawnPanLift(world, "right");
  Simulation alone = fixture::panLift();
  for (Robot* each : {left.get(), static_cast<Robot*>(&alone)}) each->setCommand({{{"pan", 0.5}}, {}, {}});
  right->setCommand({{{"lift", 0.1}}, {}, {}});
  world.step(300);
  alone.step(300);
  EXPECT_EQ(left->body().saveState(), alone.body().saveState());
  EXPECT_NE(left->body().jointPositions(), right->body().jointPositions());
}

TEST(World, LinksAndCamerasHaveTheNameOfTheirRobot) {
  World world(configOf(""));
  spawnPanLift(world, "left");
  world.step(40);
  spawnPanLift(world, "right");
  EXPECT_EQ(world.cameras().names(), (std::vector<std::string>{"left::camera", "right::camera"}));
  EXPECT_EQ(world.linkNames().front(), "left::world");
  EXPECT_EQ(world.linkNames().size(), 8u);
  const std::int64_t stamp_ns = world.stepToImage("right::camera");
  EXPECT_EQ(stamp_ns, 67000000) << "the first frame of the schedule after the robot came";
  EXPECT_TRUE(world.cameras()[0].frameDue(world.ticks())) << "both have one schedule";
}

TEST(World, CamerasSeeTheOtherRobotsWhereTheyAre) {
  World world(configOf(""));
  spawnPanLift(world, "eye");
  const std::vector<std::uint8_t> empty = world.render(0).data;
  const auto box = spawnBox(world, "box", 0.0, 0.0, "base: driven");
  const std::vector<std::uint8_t> seen = world.render(0).data;
  EXPECT_NE(seen, empty);
  box->setBase(Pose{{0.1, 0.0, 0.0}, Eigen::Quaterniond::Identity()}, Twist::Zero());
  EXPECT_NE(world.render(0).data, seen);
  EXPECT_EQ(segmentationIds(world.scene()).count("box::body"), 1u);
  world.remove("box");
  EXPECT_EQ(world.render(0).data, empty);
}

TEST(World, RobotsRestOnEachOtherAndOnWhatIsFixed) {
  World world(configOf("contacts: {ground_plane: {z_m: 0.0}}"));
  const auto low = spawnBox(world, "low", 0.0, 0.1), high = spawnBox(world, "high", 0.05, 0.35);
  const auto table = spawnBox(world, "table", 2.0, 0.5, "base: driven, contacts: {neighbours: true}");
  const auto one = spawnBox(world, "one", 2.05, 0.75), other = spawnBox(world, "other", 1.8, 0.75);
  world.step(1500);
  constexpr double kSink = 1e-3;
  EXPECT_NEAR(heightOf(*low), 0.1, kSink);
  EXPECT_NEAR(heightOf(*high), 0.3, kSink);
  EXPECT_NEAR(heightOf(*one), 0.7, kSink);
  EXPECT_NEAR(heightOf(*other), 0.1, 0.2) << "it falls over the edge";
  EXPECT_EQ(table->body().basePose().p, Eigen::Vector3d(2.0, 0.0, 0.5));

  World fewer(configOf("contacts: {ground_plane: {z_m: 0.0}}"));
  spawnBox(fewer, "table", 2.0, 0.5, "base: driven, contacts: {neighbours: true}");
  const auto same = spawnBox(fewer, "one", 2.05, 0.75);
  fewer.step(200);
  World more(configOf("contacts: {ground_plane: {z_m: 0.0}}"));
  spawnBox(more, "table", 2.0, 0.5, "base: driven, contacts: {neighbours: true}");
  const auto beside = spawnBox(more, "one", 2.05, 0.75);
  spawnBox(more, "other", 1.75, 0.75);
  more.step(200);
  EXPECT_EQ(same->body().saveState(), beside->body().saveState()) << "a table does not connect what stands on it";
}

TEST(World, TheGroundIsThatOfTheWorldAndCanBeTakenAway) {
  World world(configOf("contacts: {ground_plane: {z_m: 0.0}}"));
  const auto box = spawnBox(world, "box", 0.0, 0.1);
  world.step(100);
  EXPECT_NEAR(heightOf(*box), 0.1, 1e-3);
  world.setGround(std::nullopt);
  world.step(100);
  EXPECT_LT(heightOf(*box), 0.08);
}

TEST(World, TheSameCallsGiveTheSameBytesAlsoFromASavedStateAndAfterAReset) {
  const auto filled = [](World& world) {
    spawnBox(world, "low", 0.0, 0.1);
    spawnPanLift(world, "eye");
    spawnBox(world, "high", 0.05, 0.3);
  };
  const auto go = [](World& world, int frames) {
    for (int k = 0; k < frames; ++k) {
      world.stepToImage("eye::camera");
      world.render(0);
    }
    return world.runHash();
  };
  World world(configOf("contacts: {ground_plane: {z_m: 0.0}}"));
  filled(world);
  const std::string early = go(world, 5), state = world.saveState(), late = go(world, 10), end = world.saveState();
  World again(configOf("contacts: {ground_plane: {z_m: 0.0}}"));
  filled(again);
  again.restoreState(state);
  EXPECT_EQ(again.runHash(), early);
  EXPECT_EQ(go(again, 10), late);
  EXPECT_EQ(again.saveState(), end);
  world.reset();
  EXPECT_EQ(world.ticks(), 0);
  EXPECT_EQ(go(world, 5), early);
  EXPECT_EQ(world.saveState(), state);
  World other(configOf("contacts: {ground_plane: {z_m: 0.0}}"));
  spawnBox(other, "low", 0.0, 0.1);
  EXPECT_THROW(other.restoreState(state), StateError);
}

TEST(World, TimeGoesOnWithoutRobotsAndWhenTheLastOneGoes) {
  World world(configOf(""));
  world.step(30);
  const auto box = spawnBox(world, "box", 0.0, 1.0);
  EXPECT_EQ(box->body().ticks(), 30);
  world.step(20);
  world.remove("box");
  world.step(5);
  EXPECT_EQ(world.ticks(), 55);
  const std::string state = world.saveState();
  world.step(7);
  world.restoreState(state);
  EXPECT_EQ(world.ticks(), 55);
  EXPECT_NO_THROW(box->setBase(Pose{}, Twist::Zero())) << "the handle is still valid";
}

TEST(World, ARobotGoesOnWithOtherMassesAndGravity) {
  World world(configOf(""));
  const auto box = spawnBox(world, "box", 0.0, 1.0);
  world.step(100);
  const double speed = box->body().linkTwist(0)[2];
  world.renew("box", modelOf(kBox), Eigen::Vector3d::Zero());
  world.step(100);
  EXPECT_DOUBLE_EQ(box->body().linkTwist(0)[2], speed);
  EXPECT_EQ(world.ticks(), 200);
  std::string heavy = kBox;
  heavy.replace(heavy.find("value='2'"), 9, "value='0'");
  EXPECT_THROW(world.renew("box", modelOf(heavy), Eigen::Vector3d::Zero()), ArasError);
  EXPECT_THROW(world.renew("box", loadRobotModelFile(fixture::file("pan_lift.urdf")), Eigen::Vector3d::Zero()),
               ParameterError);
  world.step(1);
  EXPECT_DOUBLE_EQ(box->body().linkTwist(0)[2], speed);
}

TEST(World, RaysMeetLinksSolidsAndTheGround) {
  World world(configOf(
      "contacts: {ground_plane: {z_m: 0.0}}, scene: {solids: [{name: ball, sphere_m: 0.5, position_m: [0, 5, 1]}]}"));
  spawnPanLift(world, "eye");
  spawnBox(world, "box", 2.0, 1.0);
  const auto links = world.linkNames();
  const std::vector<Eigen::Vector3d> rays = {{1, 0, 0}, {0, 1, 0}, {0, 0, -1}, {0, 0, 1}};
  for (const bool visuals : {false, true}) {
    const auto hits = world.castRays({0.0, 0.0, 1.0}, rays, 0.0, 100.0, visuals);
    EXPECT_NEAR(hits[0].distance_m, 1.9, 1e-12);
    EXPECT_EQ(links[hits[0].link], "box::body");
    EXPECT_NEAR(hits[1].distance_m, 4.5, 1e-12);
    EXPECT_EQ(hits[1].link, -1);
    EXPECT_NEAR(hits[2].distance_m, 1.0, 1e-12);
    EXPECT_TRUE(std::isinf(hits[3].distance_m));
  }
  world.setModelPose("ball", Pose{{0.0, 3.0, 1.0}, Eigen::Quaterniond::Identity()});
  world.remove("box");
  const auto hits = world.castRays({0.0, 0.0, 1.0}, rays, 0.0, 100.0, false);
  EXPECT_TRUE(std::isinf(hits[0].distance_m));
  EXPECT_NEAR(hits[1].distance_m, 2.5, 1e-12);
}

TEST(World, SolidsMoveOnWhenTheRobotGoesThatTheyMovedWith) {
  World world(
      configOf("contacts: {ground_plane: {z_m: 0.0}}, scene: {solids: [{name: cube, box_m: [0.2, 0.2, 0.2], "
               "position_m: [0, 0, 1.0], mass_kg: 1.0, touches: [all]}]}"));
  world.step(10);
  EXPECT_EQ(world.models().pose("cube").p.z(), 1.0) << "there is no robot to move with";
  const auto first = spawnBox(world, "first", 3.0, 0.1), second = spawnBox(world, "second", 0.0, 0.1);
  world.step(100);
  const double speed = world.modelTwist("cube")[2];
  EXPECT_LT(speed, -0.5);
  world.remove("first");
  EXPECT_DOUBLE_EQ(world.modelTwist("cube")[2], speed);
  world.step(1500);
  EXPECT_NEAR(world.models().pose("cube").p.z(), 0.3, 2e-3) << "on the second robot";
}

TEST(World, RefusesWhatCannotBeAndChangesNothing) {
  World world(configOf(""));
  spawnBox(world, "box", 0.0, 1.0);
  const std::string before = world.saveState();
  EXPECT_HAS(messageOf<ParameterError>([&] { spawnBox(world, "box", 0.0, 1.0); }), "found twice");
  EXPECT_HAS(messageOf<ParameterError>([&] { spawnBox(world, "a::b", 0.0, 1.0); }), "a::b");
  EXPECT_HAS(messageOf<ParameterError>([&] { spawnBox(world, "", 0.0, 1.0); }), "''");
  EXPECT_HAS(messageOf<ParameterError>([&] {
               spawnBox(world, "eye", 0.0, 1.0,
                        "base: floating, cameras: [{name: c, frame: nose, width: 8, height: 8, "
                        "horizontal_fov_rad: 1.0}]");
             }),
             "nose");
  EXPECT_HAS(messageOf<ParameterError>([&] {
               spawnBox(world, "host", 0.0, 1.0, "scene: {solids: [{name: s, sphere_m: 1.0}]}, base: floating");
             }),
             "scene");
  EXPECT_HAS(messageOf<UnknownNameError>([&] { world.remove("ball"); }), "box");
  EXPECT_EQ(world.saveState(), before);
  EXPECT_EQ(world.robots().size(), 1u);
  EXPECT_EQ(world.scene().bodies.size(), 1u);
}

TEST(World, WeldsLastUntilTheyAreEndedAndAreInSavedStates) {
  World world(configOf(""));
  const auto post = spawnBox(world, "post", 0.0, 2.0, "base: driven");
  const auto box = spawnBox(world, "box", 0.5, 2.0);
  world.weld("post::body", "box::body");
  const std::string state = world.saveState();
  world.step(200);
  EXPECT_NEAR(heightOf(*box), 2.0, 1e-4);
  EXPECT_THROW(world.weld("box::body", "post::body"), ParameterError) << "they are welded already";
  EXPECT_THROW(world.weld("box::body", "box::body"), ParameterError) << "of one robot";
  EXPECT_THROW(world.weld("box::body", "post::nothing"), UnknownNameError);
  world.unweld("box::body", "post::body");
  EXPECT_THROW(world.unweld("box::body", "post::body"), UnknownNameError);
  world.step(200);
  EXPECT_LT(heightOf(*box), 1.9);
  const std::string free = world.saveState();
  world.restoreState(state);
  EXPECT_EQ(world.welds().size(), 1u);
  world.step(200);
  EXPECT_NEAR(heightOf(*box), 2.0, 1e-4);
  world.restoreState(free);
  EXPECT_TRUE(world.welds().empty());
  world.weld("post::body", "box::body");
  world.remove("post");
  EXPECT_TRUE(world.welds().empty());
  EXPECT_THROW(world.restoreState(state), StateError);
}

TEST(World, RobotsWithoutNeighboursAreNotWelded) {
  World world(configOf(""));
  spawnBox(world, "box", 0.0, 2.0);
  spawnBox(world, "alone", 0.5, 2.0, "base: floating");
  EXPECT_THROW(world.weld("box::body", "alone::body"), ParameterError);
}

}  // namespace
}  // namespace aras_visual_servo_sim::world_test
