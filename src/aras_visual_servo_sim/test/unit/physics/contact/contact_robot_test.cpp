// Robots that touch: a tool driven into a table, fingers that hold.
#include <memory>

#include "tools/physics_tools.hpp"

namespace aras_visual_servo_sim::contact_robot_test {
namespace {

constexpr double kJointFriction = 0.9;  // of the arm's joints [N m]

/** The arm with a ball for a tool, bent by `bend` (J2, -2 J3, J5) and then over a table that it would reach into. */
MultibodyWorld armOverTable(double bend, double depth_m) {
  const std::string tool =
      replaced(readUrdf("six_joint_arm.urdf"), "<link name=\"camera\"/>",
               "<link name=\"camera\"><collision><geometry><sphere radius=\"0.02\"/></geometry></collision></link>");
  WorldConfig config = publishedDrives();
  for (ControllerConfig& controller : config.controllers) {  // at rest only friction is left beside the springs
    if (controller.joint == "J2" || controller.joint == "J3" || controller.joint == "J5") controller.gains.i = 0.0;
  }
  const double tip_m = 1.6263 - (0.19688 + 0.132 + 0.41 * std::cos(bend) + 0.0718 + 0.0334) - 0.02;
  Obstacle table;
  table.name = "table";
  table.geometry.size_m = {2.0, 2.0, 0.1};
  table.X_WO.p.z() = tip_m + depth_m - 0.05;
  config.contacts.obstacles = {table};
  config.contacts.pairs = {{"robot", "table"}};
  return MultibodyWorld(modelOf(tool), config);
}

TEST(ContactRobot, AToolDrivenIntoATableStopsThereWithTheJointsInBalance) {
  constexpr double kBend = 0.4;
  MultibodyWorld world = armOverTable(kBend, 0.001);
  world.setJointPositions({{"J2", 0.6}, {"J3", -1.2}, {"J5", 0.6}});
  world.step(100);
  EXPECT_TRUE(world.contacts().empty());
  for (const auto& [joint, turn] : {std::pair{"J2", kBend}, {"J3", -2.0 * kBend}, {"J5", kBend}}) {
    world.setPosition(joint, turn);
  }
  world.step(4000);
  ASSERT_EQ(world.contacts().size(), 1u);
  const ContactForce contact = world.contacts()[0];
  EXPECT_EQ(contact.a, "camera");
  EXPECT_GT(contact.force_W.z(), 50.0);
  EXPECT_LT(contact.force_W.z(), 1000.0);  // 1e6 N/m over 1 mm, had the joints no give
  EXPECT_NEAR(contact.depth_m, contact.force_W.z() / 1e6, 1e-9);
  EXPECT_LE(std::hypot(contact.force_W.x(), contact.force_W.y()), 0.8 * contact.force_W.z() * (1.0 + 1e-6));
  EXPECT_LT(world.jointVelocities().norm(), 1e-6);
  // Virtual work at rest: effort = dV/dq - F . dp/dq, by central differences, within the joint's own friction.
  const Eigen::VectorXd q = world.jointPositions();
  const Eigen::VectorXd efforts = world.jointEfforts();
  const Pose X_WL = world.linkPose("camera");
  const Eigen::Vector3d p_L = X_WL.q.conjugate() * (contact.point_W - X_WL.p);
  for (const char* joint : {"J2", "J3", "J5"}) {
    const int i = world.model().jointIndex(joint);
    EXPECT_LE(std::abs(efforts[i]), 200.0);
    double work[2] = {0.0, 0.0};
    constexpr double kStep = 1e-5;
    for (const int side : {0, 1}) {
      world.setJointPositions({{joint, q[i] + (side ? kStep : -kStep)}});
      world.setJointVelocities(Eigen::VectorXd::Zero(q.size()));
      work[side] = world.energy() - contact.force_W.dot(world.linkPose("camera") * p_L);
    }
    world.setJointPositions({{joint, q[i]}});
    EXPECT_NEAR(efforts[i], (work[1] - work[0]) / (2.0 * kStep), kJointFriction + 1e-3) << joint;
  }
}

TEST(ContactRobot, WhatTheTableAsksForIsBoundedByTheEffortLimit) {
  MultibodyWorld world = armOverTable(0.0, 0.05);  // too deep for 200 N m of the elbow
  world.setJointPositions({{"J2", 0.7}, {"J3", -1.4}, {"J5", 0.7}});
  for (const char* joint : {"J2", "J3", "J5"}) world.setPosition(joint, 0.0);
  for (int k = 0; k < 3000; ++k) {
    world.step();
    ASSERT_LE(world.jointEfforts().tail<3>().cwiseAbs().maxCoeff(), 200.0);
  }
  ASSERT_EQ(world.contacts().size(), 1u);
  EXPECT_LT(world.contacts()[0].depth_m, 0.005);
}

constexpr double kWidth = 0.05, kMass = 0.2, kMu = 0.8;

/** A box between the open fingers, on a table, and the fingers' force. */
std::unique_ptr<MultibodyWorld> gripperOverBox() {
  WorldConfig config;
  config.controllers = {
      controllerOf("lift", ControllerType::kEffortPosition, PidGains{20000.0, 5000.0, 800.0, -200.0, 200.0, false}),
      controllerOf("left", ControllerType::kEffort)};
  Obstacle box;
  box.name = "box";
  box.geometry.size_m.setConstant(kWidth);
  box.X_WO.p = {0.0, 0.0, 0.4};
  box.mass_kg = kMass;
  Obstacle table = box;
  table.name = "table";
  table.mass_kg = 0.0;
  table.geometry.size_m = {1.0, 1.0, 0.1};
  table.X_WO.p.z() = 0.4 - 0.5 * kWidth - 0.05;
  config.contacts.obstacles = {box, table};
  config.contacts.pairs = {{"robot", "box"}, {"box", "table"}};
  config.contacts.friction = kMu;
  for (int k = 0; k < 8; ++k) {
    config.contacts.mesh_points["pad"].emplace_back(k & 1 ? 1 : -1, k & 2 ? 1 : -1, k & 4 ? 1 : -1);
  }
  auto world = std::make_unique<MultibodyWorld>(modelOf(readUrdf("parallel_gripper.urdf")), config);
  world->setJointPositions({{"left", 0.05}});
  return world;
}

TEST(ContactRobot, FingersThatMimicEachOtherHoldABoxByFrictionAndLiftIt) {
  constexpr double kGrip = 10.0;  // on both fingers together: 5 N each, 2 * 0.8 * 5 N of friction against 2 N of weight
  const auto owned = gripperOverBox();
  MultibodyWorld& world = *owned;
  world.setEffort("left", -kGrip);
  world.step(500);
  const double pinched = world.jointPositions()[world.model().jointIndex("left")];
  EXPECT_NEAR(pinched, 0.5 * kWidth, 1e-4);
  world.setPosition("lift", 0.0);
  for (int k = 0; k < 400; ++k) {
    world.setPosition("lift", 0.1 * k / 400.0);
    world.step();
  }
  world.step(1000);
  const double lifted = world.obstaclePose("box").p.z() - 0.4;
  EXPECT_NEAR(lifted, 0.1, 1e-3);
  double squeeze = 0.0, held = 0.0;
  for (const ContactForce& contact : world.contacts()) {
    const Eigen::Vector3d force = contact.a == "box" ? contact.force_W : Eigen::Vector3d(-contact.force_W);
    squeeze += 0.5 * std::abs(force.y());
    held += force.z();
  }
  EXPECT_NEAR(squeeze, 0.5 * kGrip, 1e-3);
  EXPECT_NEAR(held, kMass * kGravity, 1e-3);
  const auto inTheHand = [&] { return world.obstaclePose("box").p.z() - world.linkPose("hand").p.z(); };
  const double where = inTheHand();
  world.step(5000);
  EXPECT_NEAR(inTheHand(), where, 1e-6);  // it does not creep
}

TEST(ContactRobot, AGripTooWeakLetsTheBoxSlideOut) {
  const auto owned = gripperOverBox();
  MultibodyWorld& world = *owned;
  world.setEffort("left", -2.0);  // 2 * 0.8 * 1 N < 2 N
  world.step(500);
  for (int k = 0; k < 1000; ++k) {
    world.setPosition("lift", 0.2 * k / 1000.0);
    world.step();
  }
  EXPECT_LT(world.obstaclePose("box").p.z(), 0.45);
}

}  // namespace
}  // namespace aras_visual_servo_sim::contact_robot_test
