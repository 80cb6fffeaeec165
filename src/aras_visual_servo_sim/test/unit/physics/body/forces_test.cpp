// Forces from outside, and what inertial and force sensors measure.
#include <map>
#include <memory>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "tools/physics_tools.hpp"

namespace aras_visual_servo_sim::forces_test {
namespace {

using Eigen::Vector3d;

constexpr double kRounding = 1e-12;  // a few products of numbers up to ten
constexpr double kPeriodS = 1e-5;
// Differences over a period are of first order in it; what is compared changes by less than a thousand of its units
// in a second.
constexpr double kDifference = 1000.0 * kPeriodS;

Twist stacked(const Vector3d& a, const Vector3d& b) { return (Twist() << a, b).finished(); }

TEST(Pushes, AForceMovesABlockAsItsMassSays) {
  MultibodyWorld world(sliderModel(), weightless());
  world.push({{"block", stacked({6, 5, 4}, Vector3d::Zero())}}, {});
  world.step(10);
  EXPECT_NEAR(world.jointVelocities()[0], 6.0 / 3.0 * 0.01, kRounding);
  EXPECT_LT((world.linkAcceleration("block") - stacked({2, 0, 0}, Vector3d::Zero())).norm(), kRounding);
}

TEST(Pushes, AnEffortTurnsAJointBesidesItsActuator) {
  MultibodyWorld world(modelOf(readUrdf("pendulum.urdf")), weightless());
  const double inertia = 0.05 + 2.0 * 0.25;
  world.push({}, {{"swing", 2.0 * inertia}});
  world.step();
  EXPECT_LT((world.linkAcceleration("bob") - stacked(Vector3d::Zero(), {0, 2, 0})).norm(), kRounding);
  EXPECT_EQ(world.jointEfforts()[0], 0.0);
}

TEST(Pushes, AForceActsAtTheCentreOfMass) {
  MultibodyWorld world(modelOf(readUrdf("pendulum.urdf")), weightless());
  const double inertia = 0.05 + 2.0 * 0.25;
  world.push({{"bob", stacked({4, 0, 0}, Vector3d::Zero())}}, {});  // half a metre below the axis
  world.step();
  EXPECT_NEAR(world.linkAcceleration("bob")[4], -0.5 * 4.0 / inertia, kRounding);
  world.reset(vectorOf({0.0}));
  world.push({{"bob", stacked({4, 0, 0}, {0, 2, 0})}}, {});
  world.step();
  EXPECT_NEAR(world.linkAcceleration("bob")[4], 0.0, kRounding);
}

TEST(Pushes, TakeThePlaceOfThoseBeforeAndEndWithAReset) {
  MultibodyWorld world(sliderModel(), weightless());
  const Twist force = stacked({3, 0, 0}, Vector3d::Zero());
  world.push({{"block", force}}, {{"slide", 1.0}});
  world.push({{"block", force}}, {});
  world.step();
  EXPECT_NEAR(world.linkAcceleration("block")[0], 1.0, kRounding);
  world.push({}, {});
  world.step();
  EXPECT_NEAR(world.linkAcceleration("block")[0], 0.0, kRounding);
  world.push({{"block", force}}, {});
  world.reset(vectorOf({0.0}));
  world.step();
  EXPECT_EQ(world.jointVelocities()[0], 0.0);
}

TEST(Pushes, OnTheWorldOrOnAFloatingBase) {
  MultibodyWorld held(sliderModel(), weightless());
  held.push({{"world", stacked({9, 9, 9}, {9, 9, 9})}}, {});
  held.step();
  EXPECT_EQ(held.jointVelocities()[0], 0.0);
  WorldConfig config = weightless();
  config.base = Base::kFloating;
  MultibodyWorld ball(modelOf(R"(<robot name="b"><link name="ball"><inertial><mass value="2"/>
    <inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link></robot>)"),
                      config);
  ball.push({{"ball", stacked({2, 4, 6}, {0.1, 0.2, 0.3})}}, {});
  ball.step();
  EXPECT_LT((ball.linkAcceleration("ball") - stacked({1, 2, 3}, {1, 2, 3})).norm(), kRounding / 0.001);
}

TEST(Pushes, ThatCannotBeAreNamedAndChangeNothing) {
  MultibodyWorld world(sliderModel(), weightless());
  world.push({{"block", stacked({3, 0, 0}, Vector3d::Zero())}}, {});
  const Twist none = stacked({0, std::nan(""), 0}, Vector3d::Zero());
  EXPECT_EQ(messageOf<NotFiniteError>([&] {
              world.push({{"block", none}}, {});
            }),
            "link 'block': a force is not finite, must be finite");
  EXPECT_EQ(messageOf<NotFiniteError>([&] {
              world.push({}, {{"slide", HUGE_VAL}});
            }),
            "joint 'slide': an effort is not finite, must be finite");
  EXPECT_HAS(messageOf<UnknownNameError>([&] { world.push({{"moon", Twist::Zero()}}, {}); }), "moon");
  EXPECT_HAS(messageOf<UnknownNameError>([&] { world.push({}, {{"moon", 1.0}}); }), "moon");
  EXPECT_EQ(messageOf<UnknownNameError>([&] { world.jointWrench("moon"); }), "joint 'moon' does not exist");
  world.step();
  EXPECT_NEAR(world.linkAcceleration("block")[0], 1.0, kRounding);
}

/** tilted_chain.urdf in motion and under forces, fixed or with a root that has mass and floats. */
std::unique_ptr<MultibodyWorld> chainInMotion(bool floating) {
  std::string urdf = readUrdf("tilted_chain.urdf");
  WorldConfig config;
  config.period_s = kPeriodS;
  if (floating) {
    urdf =
        replaced(urdf, "<link name=\"world\"/>",
                 "<link name=\"world\"><inertial><origin xyz=\"0.04 -0.02 0.06\"/><mass value=\"3.1\"/><inertia "
                 "ixx=\"0.11\" iyy=\"0.08\" izz=\"0.06\" ixy=\"0.01\" ixz=\"-0.012\" iyz=\"0.02\"/></inertial></link>");
    config.base = Base::kFloating;
    config.X_WB = Pose{{0.3, -0.2, 1.1}, quaternionFromRpy({0.4, -0.7, 1.2})};
  }
  auto world = std::make_unique<MultibodyWorld>(modelOf(urdf), config);
  world->reset(vectorOf({0.4, -1.1, 2.3}));
  world->setJointVelocities(vectorOf({0.7, -1.9, 1.3}));
  if (floating) world->setBaseTwist(stacked({0.3, -0.4, 0.2}, {0.8, -0.5, 0.6}));
  world->push({{"lower", stacked({3, -2, 1}, {0.2, 0.3, -0.1})}}, {{"drawer", 0.4}});
  return world;
}

TEST(InertialSensor, MeasuresTheDerivativeOfEveryLinksTwist) {
  for (const bool floating : {false, true}) {
    const auto made = chainInMotion(floating);
    MultibodyWorld& world = *made;
    const auto twists = [&] {
      std::map<std::string, Twist> all;
      for (const Link& link : world.model().links) {
        const Eigen::Quaterniond q = world.linkPose(link.name).q;
        const Twist V = world.linkTwist(link.name);
        all[link.name] = stacked(q * V.head<3>(), q * V.tail<3>());
      }
      return all;
    };
    const auto before = twists();
    world.step();
    for (const auto& [link, after] : twists()) {
      const Eigen::Quaterniond q = world.linkPose(link).q;
      const Twist found = world.linkAcceleration(link), expected = (after - before.at(link)) / kPeriodS;
      EXPECT_LT((q * found.head<3>() - expected.head<3>()).norm(), kDifference) << link << floating;
      EXPECT_LT((q * found.tail<3>() - expected.tail<3>()).norm(), kDifference) << link << floating;
    }
  }
}

TEST(InertialSensor, OfADrivenBaseFeelsNothing) {
  WorldConfig config;
  config.base = Base::kDriven;
  MultibodyWorld world(modelOf(readUrdf("driven_camera.urdf")), config);
  world.setCommand(world.twistCommand(stacked({1, 2, 3}, {0.1, 0.2, 0.3}), ""));
  world.step();
  EXPECT_EQ(world.linkAcceleration(world.model().links.back().name), Twist::Zero());
}

/** Of all links beyond the shoulder: linear momentum, and angular momentum about its origin. */
Twist momentumOf(const MultibodyWorld& world, const Vector3d& p_WJ) {
  Twist sum = Twist::Zero();
  for (const Link& link : world.model().links) {
    if (link.mass_kg == 0.0) continue;
    const Pose X = world.linkPose(link.name);
    const Twist V = world.linkTwist(link.name);
    const Vector3d w = V.tail<3>(), p = X.q * (link.mass_kg * (V.head<3>() + w.cross(link.com_m)));
    sum += stacked(p, (X * link.com_m - p_WJ).cross(p) + X.q * (link.inertia_kg_m2 * w));
  }
  return sum;
}

TEST(ForceSensor, MeasuresWhatChangesTheMomentumBeyondItsJoint) {
  const auto made = chainInMotion(false);
  MultibodyWorld& world = *made;
  const Vector3d p_WJ = world.linkPose("upper").p, gravity(0, 0, -kGravity);
  const Twist before = momentumOf(world, p_WJ);
  world.step();
  Twist others = Twist::Zero();  // that act on the links
  for (const Link& link : world.model().links) {
    const Vector3d arm = world.linkPose(link.name) * link.com_m - p_WJ, weight = link.mass_kg * gravity;
    others += stacked(weight, arm.cross(weight));
    if (link.name == "lower") others += stacked({3, -2, 1}, Vector3d(0.2, 0.3, -0.1) + arm.cross(Vector3d(3, -2, 1)));
  }
  const Twist from_parent = (momentumOf(world, p_WJ) - before) / kPeriodS - others;
  const Eigen::Quaterniond q = world.linkPose("upper").q;
  const Twist found = world.jointWrench("shoulder");
  EXPECT_LT((q * found.head<3>() + from_parent.head<3>()).norm(), kDifference);
  EXPECT_LT((q * found.tail<3>() + from_parent.tail<3>()).norm(), kDifference);
}

TEST(ForceSensor, InAFixedJointFeelsWhatTheFootStandsOn) {
  const std::string inertia = "<inertia ixx='0.01' iyy='0.01' izz='0.01' ixy='0' ixz='0' iyz='0'/></inertial>";
  WorldConfig config;
  Obstacle table;
  table.name = "table";
  table.geometry.size_m = {1.0, 1.0, 0.1};
  table.X_WO.p.z() = -0.15;
  config.contacts.obstacles = {table};
  config.contacts.pairs = {{"foot", "table"}};
  MultibodyWorld world(
      modelOf("<robot name='leg'><link name='world'/><link name='leg'><inertial><mass value='2'/>" + inertia +
              "</link><link name='foot'><inertial><mass value='1'/>" + inertia +
              "<collision><geometry><sphere radius='0.1'/></geometry></collision></link>"
              "<joint name='lift' type='prismatic'><parent link='world'/><child link='leg'/><axis xyz='0 0 1'/>"
              "<limit lower='-1' upper='1' effort='9' velocity='9'/></joint>"
              "<joint name='ankle' type='fixed'><parent link='leg'/><child link='foot'/></joint></robot>"),
      config);
  world.step(3000);
  constexpr double kSettled = 1e-6;  // [N] of what is left of the motion after three seconds
  EXPECT_LT((world.jointWrench("ankle") - stacked({0, 0, 2.0 * kGravity}, Vector3d::Zero())).norm(), kSettled);
  EXPECT_LT(world.jointWrench("lift").norm(), kSettled);
}

}  // namespace
}  // namespace aras_visual_servo_sim::forces_test
