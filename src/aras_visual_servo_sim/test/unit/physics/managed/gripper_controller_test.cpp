#include "aras_visual_servo_sim/physics/managed/gripper_controller.hpp"

#include "aras_visual_servo_sim/config/errors.hpp"
#include "tools/two_joints.hpp"

namespace aras_visual_servo_sim::gripper_controller_test {
namespace {

struct Hand {
  explicit Hand(const std::string& kind, const std::string& more = "")
      : world(twoJoints(kind == "position" ? "PositionJointInterface" : "EffortJointInterface"), weightless()) {
    world.loadController("hand", YAML::Load("{type: " + kind + "_controllers/GripperActionController, joint: a, " +
                                            "goal_tolerance: 0.001, stall_timeout: 0.2" + more + "}"));
    world.switchControllers({"hand"}, {}, true);
  }
  GripperController& hand() { return static_cast<GripperController&>(world.runningController("hand")); }

  MultibodyWorld world;
};

TEST(GripperController, ReachesWhereItIsTold) {
  for (const char* kind : {"position", "effort"}) {
    Hand hand(kind, std::string(kind) == "effort" ? ", gains: {a: {p: 500, d: 20}}" : "");
    hand.hand().pursue(0.5, std::string(kind) == "effort" ? 50.0 : 0.0, 0.0);  // a position joint has no such limit
    hand.world.step(2000);
    EXPECT_EQ(hand.hand().state(), GripperController::State::kReached) << kind;
    EXPECT_NEAR(hand.world.jointPositions()[0], 0.5, 1e-3) << kind;
  }
}

TEST(GripperController, StallsAtAStopWithTheEffortItMayUse) {
  Hand hand("effort", ", gains: {a: {p: 500, d: 20}}");
  hand.hand().pursue(3.5, 7.0, 0.0);  // the stop is at 3
  hand.world.step(4000);
  EXPECT_EQ(hand.hand().state(), GripperController::State::kStalled);
  EXPECT_NEAR(hand.world.jointPositions()[0], 3.0, 1e-9);
  EXPECT_LE(std::abs(hand.world.jointEfforts()[0]), 7.0);
}

TEST(GripperController, HoldsWhereItIsWhenItsGoalIsCancelled) {
  Hand hand("position");
  hand.hand().pursue(2.0, 0.0, 0.0);
  hand.world.step(50);
  const double here = hand.world.jointPositions()[0];
  hand.hand().cancel(hand.world.jointsOf(hand.hand()).front());
  hand.world.step(100);
  EXPECT_EQ(hand.hand().state(), GripperController::State::kPreempted);
  EXPECT_NEAR(hand.world.jointPositions()[0], here, 1e-9);
  EXPECT_THROW(hand.hand().pursue(std::nan(""), 0.0, 0.0), NotFiniteError);
}

}  // namespace
}  // namespace aras_visual_servo_sim::gripper_controller_test
