#include "aras_visual_servo_sim/physics/touching_robots.hpp"

#include <memory>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "tools/physics_tools.hpp"

namespace aras_visual_servo_sim::touching_robots_test {
namespace {

constexpr double kStiffness = 1e6;  // [N/m], of a point of contact

const char kInertial[] =
    "<inertial><mass value='2'/><inertia ixx='0.02' iyy='0.02' izz='0.02' ixy='0' ixz='0' iyz='0'/></inertial>";

/** A box of 0.2 m that is free, or slides along x without friction. */
RobotModel boxModel(bool slides) {
  std::string text = std::string("<robot name='box'>");
  if (slides) text += "<link name='world'/>";
  text += std::string("<link name='body'>") + kInertial +
          "<collision><geometry><box size='0.2 0.2 0.2'/></geometry></collision></link>";
  if (slides) {
    text +=
        "<joint name='slide' type='prismatic'><parent link='world'/><child link='body'/><axis xyz='1 0 0'/>"
        "<limit lower='-10' upper='10' effort='100' velocity='50'/></joint>";
  }
  return modelOf(text + "</robot>");
}

std::unique_ptr<MultibodyWorld> boxAt(const Eigen::Vector3d& p, bool slides, bool ground, bool neighbours = true) {
  WorldConfig config;
  config.gravity_m_s2 = {0.0, 0.0, -kGravity};
  config.base = slides ? Base::kFixed : Base::kFloating;
  config.X_WB = Pose{p, Eigen::Quaterniond::Identity()};
  config.contacts.neighbours = neighbours;
  if (ground) config.contacts.ground = GroundPlane{0.0, 0.8};
  return std::make_unique<MultibodyWorld>(boxModel(slides), config);
}

void step(const std::vector<MultibodyWorld*>& worlds, int n) {
  TouchingRobots group(worlds);
  for (int k = 0; k < n; ++k) group.step();
}

TEST(TouchingRobots, OneRobotRestsOnAnotherWhichCarriesTheWeightOfBoth) {
  const auto low = boxAt({0.0, 0.0, 0.1}, false, true), high = boxAt({0.0, 0.0, 0.35}, false, true);
  step({low.get(), high.get()}, 2000);
  const double weight = 2.0 * kGravity;
  const double sink = weight / (4.0 * kStiffness);  // of four corners
  EXPECT_NEAR(high->basePose().p.z(), 0.3 - 3.0 * sink, 1e-9) << "the lower one carries two";
  EXPECT_NEAR(low->basePose().p.z(), 0.1 - 2.0 * sink, 1e-9);
  Eigen::Vector3d on_high = Eigen::Vector3d::Zero(), on_low = on_high, from_ground = on_high;
  for (const ContactForce& force : high->contacts()) {
    EXPECT_EQ(force.a == "another robot", force.b == "body");
    on_high += force.b == "body" ? Eigen::Vector3d(-force.force_W) : force.force_W;
  }
  for (const ContactForce& force : low->contacts()) {
    if (force.b == "ground_plane") from_ground += force.force_W;
    if (force.b == "another robot") on_low += force.force_W;
    if (force.a == "another robot") on_low -= force.force_W;
  }
  EXPECT_NEAR(on_high.z(), weight, 1e-6);
  EXPECT_NEAR((on_high + on_low).norm(), 0.0, 1e-12) << "action and reaction";
  EXPECT_NEAR(from_ground.z(), 2.0 * weight, 1e-6);
}

TEST(TouchingRobots, TwoRobotsThatMeetKeepTheirMomentum) {
  const auto left = boxAt({0.0, 0.0, 1.0}, true, false), right = boxAt({0.5, 0.02, 1.0}, true, false);
  left->setJointVelocities(vectorOf({2.0}));
  step({left.get(), right.get()}, 400);
  const double a = left->jointVelocities()[0], b = right->jointVelocities()[0];
  EXPECT_NEAR(a + b, 2.0, 1e-12);
  EXPECT_GE(b, a) << "they do not go through each other";
  EXPECT_GT(b, 0.9);
  EXPECT_GT(right->jointPositions()[0] + 0.5 - left->jointPositions()[0], 0.2 - 1e-3);
}

TEST(TouchingRobots, RobotsThatTouchNothingStepAsAlone) {
  const auto one = boxAt({0.0, 0.0, 0.3}, false, true), other = boxAt({5.0, 0.0, 0.3}, false, true);
  const auto alone = boxAt({0.0, 0.0, 0.3}, false, true);
  step({one.get(), other.get()}, 600);
  alone->step(600);
  EXPECT_EQ(one->saveState(), alone->saveState());
}

TEST(TouchingRobots, ARobotThatIsNotConfiguredForItGoesThroughOthers) {
  const auto low = boxAt({0.0, 0.0, 0.1}, false, true, false), high = boxAt({0.0, 0.0, 0.4}, false, true);
  step({low.get(), high.get()}, 1500);
  EXPECT_NEAR(high->basePose().p.z(), 0.1, 1e-4);
}

TEST(TouchingRobots, TheSameGroupFromASavedStateGoesOnWithTheSameBytes) {
  const auto low = boxAt({0.0, 0.0, 0.1}, false, true), high = boxAt({0.05, 0.03, 0.35}, false, true);
  step({low.get(), high.get()}, 250);
  const std::string a = low->saveState(), b = high->saveState();
  step({low.get(), high.get()}, 300);
  const auto low_again = boxAt({0.0, 0.0, 0.1}, false, true), high_again = boxAt({0.05, 0.03, 0.35}, false, true);
  low_again->restoreState(a);
  high_again->restoreState(b);
  for (int k = 0; k < 300; ++k) step({low_again.get(), high_again.get()}, 1);
  EXPECT_EQ(low->saveState(), low_again->saveState());
  EXPECT_EQ(high->saveState(), high_again->saveState());
}

/** Holds the bodies of neighbouring boxes to each other. */
std::vector<Weld> chainOf(const std::vector<MultibodyWorld*>& worlds) {
  std::vector<Weld> welds;
  for (std::size_t k = 0; k + 1 < worlds.size(); ++k) {
    const Pose X_AB = worlds[k]->linkPose("body").inverse() * worlds[k + 1]->linkPose("body");
    welds.push_back({k, k + 1, worlds[k]->model().linkIndex("body"), worlds[k + 1]->model().linkIndex("body"), X_AB});
  }
  return welds;
}

TEST(TouchingRobots, WeldedBodiesMoveAsOneAndKeepTheirMomentum) {
  const auto left = boxAt({0.0, 0.0, 5.0}, false, false), right = boxAt({0.5, 0.0, 5.0}, false, false);
  const std::vector<MultibodyWorld*> both{left.get(), right.get()};
  Twist twist = Twist::Zero();
  twist[1] = 1.0;
  left->setBaseTwist(twist);
  TouchingRobots group(both, {"left", "right"}, chainOf(both));
  for (int k = 0; k < 400; ++k) group.step();
  const Pose X_LR = left->basePose().inverse() * right->basePose();
  EXPECT_NEAR((X_LR.p - Eigen::Vector3d(0.5, 0.0, 0.0)).norm(), 0.0, 1e-4);
  EXPECT_NEAR(X_LR.q.vec().norm(), 0.0, 1e-4);
  const Eigen::Vector3d middle = 0.5 * (left->basePose().p + right->basePose().p);
  EXPECT_NEAR(middle.y(), 0.5 * 1.0 * 0.4, 1e-3) << "half the speed of the one that was pushed";
  EXPECT_NEAR(5.0 - middle.z(), 0.5 * kGravity * 0.16, 2e-3) << "they fall freely";
  EXPECT_TRUE(left->contacts().empty()) << "a weld is no contact";
}

TEST(TouchingRobots, WeldsActTogetherWithManyContacts) {
  std::vector<std::unique_ptr<MultibodyWorld>> boxes;
  std::vector<MultibodyWorld*> worlds;
  for (int k = 0; k < 7; ++k) {  // 28 points on the ground and 18 of welds, more than are solved for as they are
    boxes.push_back(boxAt({0.2 * k, 0.0, 0.1}, false, true));
    worlds.push_back(boxes.back().get());
  }
  TouchingRobots group(worlds, {}, chainOf(worlds));
  for (int k = 0; k < 300; ++k) group.step();
  const double sink = 2.0 * kGravity / (4.0 * kStiffness);
  for (const auto& box : boxes) {
    EXPECT_NEAR(box->basePose().p.z(), 0.1 - sink, 1e-6);
    EXPECT_EQ(box->unsettledSteps(), 0u);
  }
  boxes[3]->push({{"body", (Twist() << 0.0, 0.0, 7.5 * 2.0 * kGravity, 0.0, 0.0, 0.0).finished()}}, {});
  for (int k = 0; k < 100; ++k) group.step();
  for (const auto& box : boxes) EXPECT_GT(box->basePose().p.z(), 0.102) << "the one that is pulled lifts all";
}

TEST(TouchingRobots, ContactsNameTheLinkOfTheOtherRobot) {
  const auto low = boxAt({0.0, 0.0, 0.1}, false, true), high = boxAt({0.0, 0.0, 0.3}, false, true);
  TouchingRobots group({low.get(), high.get()}, {"low", "high"});
  for (int k = 0; k < 50; ++k) group.step();
  ASSERT_FALSE(high->contacts().empty());
  for (const ContactForce& force : high->contacts()) EXPECT_TRUE(force.a == "low::body" || force.b == "low::body");
}

}  // namespace
}  // namespace aras_visual_servo_sim::touching_robots_test
