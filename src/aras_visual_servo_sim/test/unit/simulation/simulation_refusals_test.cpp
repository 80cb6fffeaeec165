// What is said to who asks a simulation for what it cannot do: which thing, what was found, what is allowed.
#include <string>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "tools/pan_lift.hpp"
#include "tools/physics_tools.hpp"

namespace aras_visual_servo_sim {
namespace {

const char* const kTriggered =
    "cameras: [{name: camera, frame: eye_optical_frame, width: 8, height: 8, horizontal_fov_rad: 1.0, rate_hz: 30.0, "
    "triggered: true}]";

TEST(SimulationRefusals, StepsAreNotTakenBack) {
  Simulation simulation = fixture::panLift();
  EXPECT_EQ(messageOf<ParameterError>([&] { simulation.step(-1); }), "step: found -1 steps, allowed >= 0");
}

TEST(SimulationRefusals, AFrameIsTakenWhenItIsDue) {
  Simulation simulation = fixture::panLift();
  simulation.step(1);
  EXPECT_EQ(messageOf<ParameterError>([&] { simulation.takeFrame(0); }), "camera 'camera': no frame is due at tick 1");
}

TEST(SimulationRefusals, ATriggeredCameraIsNotWaitedForUnasked) {
  Simulation simulation = fixture::panLift(kTriggered);
  EXPECT_EQ(messageOf<ParameterError>([&] { simulation.stepToImage("camera"); }),
            "camera 'camera': takes frames only when triggered, and nobody asked for one");
}

TEST(SimulationRefusals, AnUnknownCameraIsToldWhichThereAre) {
  const Simulation simulation = fixture::panLift();
  EXPECT_EQ(messageOf<UnknownNameError>([&] { simulation.cameras().index("eye"); }),
            "camera 'eye': not found, cameras are: camera");
  const Simulation blind = fixture::panLift("cameras: []");
  EXPECT_EQ(messageOf<UnknownNameError>([&] { blind.cameras().index("eye"); }),
            "camera 'eye': not found, cameras are: none");
}

TEST(SimulationRefusals, TwoCamerasHaveTwoNames) {
  const auto twice = [] {
    fixture::panLift(
        "cameras: [{name: eye, frame: head, width: 8, height: 8, horizontal_fov_rad: 1.0, rate_hz: 10.0},"
        " {name: eye, frame: head, width: 8, height: 8, horizontal_fov_rad: 1.0, rate_hz: 10.0}]");
  };
  EXPECT_HAS(messageOf<ParameterError>(twice), "camera 'eye': found twice, allowed once");
}

TEST(SimulationRefusals, CamerasKeepTheirViewWhileRunning) {
  Simulation simulation = fixture::panLift();
  CameraConfig other = simulation.cameras()[0].model().config();
  other.width = 32;
  other.rate_hz = 15.0;
  const std::string said = messageOf<ParameterError>([&] { simulation.setCameras({other}); });
  EXPECT_EQ(said,
            "camera 'camera': size: found another one, allowed that of the start\n"
            "camera 'camera': rate_hz: found another one, allowed that of the start");
  EXPECT_EQ(messageOf<ParameterError>([&] { simulation.setCameras({}); }),
            "cameras: found 0, allowed 1, as at the start");
  EXPECT_EQ(simulation.cameras()[0].model().width(), 64);
}

TEST(SimulationRefusals, EachPartOfACamerasViewIsHeld) {
  Simulation simulation = fixture::panLift();
  const CameraConfig same = simulation.cameras()[0].model().config();
  const auto said = [&](const auto& change) {
    CameraConfig other = same;
    change(other);
    return messageOf<ParameterError>([&] { simulation.setCameras({other}); });
  };
  EXPECT_HAS(said([](CameraConfig& c) { c.name = "eye"; }), "camera 'camera': name: found another one");
  EXPECT_HAS(said([](CameraConfig& c) { c.frame = "head"; }), "frame: found another one");
  EXPECT_HAS(said([](CameraConfig& c) { c.X_MC.p.x() = 0.1; }), "pose: found another one");
  EXPECT_HAS(said([](CameraConfig& c) { c.height = 47; }), "size: found another one");
  EXPECT_HAS(said([](CameraConfig& c) { c.horizontal_fov_rad = 1.1; }), "intrinsics: found another one");
  EXPECT_HAS(said([](CameraConfig& c) { c.distortion_model = "plumb_bob"; }), "distortion: found another one");
  EXPECT_HAS(said([](CameraConfig& c) { c.triggered = true; }), "rate_hz: found another one");
  EXPECT_HAS(said([](CameraConfig& c) { c.encoding = "mono8"; }), "encoding: found another one");
  EXPECT_HAS(said([](CameraConfig& c) { c.baseline_m = 0.1; }), "baseline_m: found another one");
  EXPECT_NO_THROW(simulation.setCameras({same}));
}

TEST(SimulationRefusals, AnUnknownModelIsToldWhichThereAre) {
  Simulation simulation = fixture::panLift();
  EXPECT_EQ(messageOf<UnknownNameError>([&] { simulation.deleteModel("moon"); }),
            "model 'moon' does not exist; models: target");
  simulation.deleteModel("target");
  EXPECT_EQ(messageOf<UnknownNameError>([&] { simulation.setModelPose("target", Pose()); }),
            "model 'target' does not exist; models: none");
}

TEST(SimulationRefusals, ASpawnedModelHasANameOfItsOwn) {
  Simulation simulation = fixture::panLift();
  const std::string said = "a model or link of this name exists, allowed: another name";
  EXPECT_EQ(messageOf<ParameterError>([&] { simulation.spawnModel(YAML::Load("{name: target, sphere_m: 1}")); }),
            "model 'target': " + said);
}

TEST(SimulationRefusals, AStartThatIsNoJointIsToldWhichThereAre) {
  const auto start = [] { fixture::panLift("initial_positions: {elbow: 0.1}"); };
  EXPECT_HAS(messageOf<ParameterError>(start), "joint 'elbow' does not exist or does not move, allowed: lift, pan");
}

TEST(SimulationRefusals, AnOldCommandIsToldWhatIsAllowed) {
  Simulation simulation = fixture::panLift("command_timeout_s: 0.1");
  simulation.step(500);
  const JointCommand command{{{"pan", 0.1}}, {}, {}};
  EXPECT_EQ(messageOf<ParameterError>([&] { simulation.setCommand(command, 100000000); }),
            "command: stamp is 0.400000 s old, allowed <= 0.100000 s (sim/command_timeout_s)");
  EXPECT_EQ(messageOf<ParameterError>([&] { simulation.setCommand(command, 600000000); }),
            "command: stamp is 0.100000 s in the future, now is 0.500000 s of simulated time");
}

TEST(SimulationRefusals, WithoutATimeoutACommandIsNeverTooOld) {
  Simulation simulation = fixture::panLift("command_timeout_s: 0");
  simulation.step(500);
  EXPECT_NO_THROW(simulation.setCommand(JointCommand{{{"pan", 0.1}}, {}, {}}, 0));
}

TEST(SimulationRefusals, ATwistOfARobotThatDoesNotDriveIsCounted) {
  Simulation simulation = fixture::panLift();
  const std::string said = messageOf<ArasError>([&] { simulation.setTwist(Twist::Zero(), ""); });
  EXPECT_HAS(said, "the base is not driven (sim/base: driven)");
  EXPECT_EQ(simulation.commands().refused(), 1u);
  EXPECT_EQ(simulation.commands().lastRefusal(), said);
}

}  // namespace
}  // namespace aras_visual_servo_sim
