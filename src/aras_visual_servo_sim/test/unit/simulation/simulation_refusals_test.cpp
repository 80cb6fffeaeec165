// Errors of a simulation name the thing, what was found and what is allowed, and change nothing.
#include <string>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "tools/pan_lift.hpp"
#include "tools/physics_tools.hpp"

namespace aras_visual_servo_sim::simulation_refusals_test {
namespace {

TEST(SimulationRefusals, NegativeStepsAreRefusedAndNoneChangeNothing) {
  Simulation simulation = fixture::panLift();
  EXPECT_HAS(messageOf<ParameterError>([&] { simulation.step(-1); }), "found -1");
  simulation.step(0);
  EXPECT_EQ(simulation.ticks(), 0);
}

TEST(SimulationRefusals, AFrameIsTakenWhenItIsDue) {
  Simulation simulation = fixture::panLift();
  simulation.step(1);
  EXPECT_HAS(messageOf<ParameterError>([&] { simulation.takeFrame(0); }), "camera 'camera'");
  Simulation triggered = fixture::panLift(
      "cameras: [{name: camera, frame: eye_optical_frame, width: 8, height: 8, horizontal_fov_rad: 1.0, rate_hz: 30.0, "
      "triggered: true}]");
  EXPECT_HAS(messageOf<ParameterError>([&] { triggered.stepToImage("camera"); }), "triggered");
}

TEST(SimulationRefusals, AnUnknownNameIsToldWhichThereAre) {
  Simulation simulation = fixture::panLift();
  EXPECT_HAS(messageOf<UnknownNameError>([&] { simulation.cameras().index("eye"); }), "cameras are: camera");
  const Simulation blind = fixture::panLift("cameras: []");
  EXPECT_HAS(messageOf<UnknownNameError>([&] { blind.cameras().index("eye"); }), "cameras are: none");
  EXPECT_HAS(messageOf<UnknownNameError>([&] { simulation.deleteModel("moon"); }), "models: target");
  EXPECT_HAS(messageOf<ParameterError>([&] { simulation.spawnModel(YAML::Load("{name: target, sphere_m: 1}")); }),
             "model 'target'");
  simulation.deleteModel("target");
  EXPECT_HAS(messageOf<UnknownNameError>([&] { simulation.setModelPose("target", Pose()); }), "models: none");
  const auto start = [] { fixture::panLift("initial_positions: {elbow: 0.1}"); };
  EXPECT_HAS(messageOf<ParameterError>(start), "joint 'elbow'");
  EXPECT_HAS(messageOf<ParameterError>(start), "allowed: lift, pan");
  const auto twice = [] {
    fixture::panLift(
        "cameras: [{name: eye, frame: head, width: 8, height: 8, horizontal_fov_rad: 1.0, rate_hz: 10.0},"
        " {name: eye, frame: head, width: 8, height: 8, horizontal_fov_rad: 1.0, rate_hz: 10.0}]");
  };
  EXPECT_HAS(messageOf<ParameterError>(twice), "camera 'eye': found twice");
}

TEST(SimulationRefusals, CamerasKeepTheirViewWhileRunning) {
  Simulation simulation = fixture::panLift();
  const CameraConfig same = simulation.cameras()[0].model().config();
  const auto said = [&](const auto& change) {
    CameraConfig other = same;
    change(other);
    return messageOf<ParameterError>([&] { simulation.setCameras({other}); });
  };
  EXPECT_HAS(said([](CameraConfig& c) { c.name = "eye"; }), "camera 'camera': name");
  EXPECT_HAS(said([](CameraConfig& c) { c.frame = "head"; }), "frame");
  EXPECT_HAS(said([](CameraConfig& c) { c.X_MC.p.x() = 0.1; }), "pose");
  EXPECT_HAS(said([](CameraConfig& c) { c.height = 47; }), "size");
  EXPECT_HAS(said([](CameraConfig& c) { c.horizontal_fov_rad = 1.1; }), "intrinsics");
  EXPECT_HAS(said([](CameraConfig& c) { c.distortion_model = "plumb_bob"; }), "distortion");
  EXPECT_HAS(said([](CameraConfig& c) { c.triggered = true; }), "rate_hz");
  EXPECT_HAS(said([](CameraConfig& c) { c.encoding = "mono8"; }), "encoding");
  EXPECT_HAS(said([](CameraConfig& c) { c.baseline_m = 0.1; }), "baseline_m");
  const std::string both = said([](CameraConfig& c) {
    c.width = 32;
    c.rate_hz = 15.0;
  });
  EXPECT_HAS(both, "size");
  EXPECT_HAS(both, "rate_hz");
  EXPECT_HAS(messageOf<ParameterError>([&] { simulation.setCameras({}); }), "found 0, allowed 1");
  EXPECT_NO_THROW(simulation.setCameras({same}));
  EXPECT_EQ(simulation.cameras()[0].model().width(), 64);
}

TEST(SimulationRefusals, AnOldCommandIsToldWhatIsAllowed) {
  Simulation simulation = fixture::panLift("command_timeout_s: 0.1");
  simulation.step(500);
  const JointCommand command{{{"pan", 0.1}}, {}, {}};
  const std::string old = messageOf<ParameterError>([&] { simulation.setCommand(command, 100000000); });
  EXPECT_HAS(old, "0.400000 s");
  EXPECT_HAS(old, "allowed <= 0.100000 s (sim/command_timeout_s)");
  EXPECT_HAS(messageOf<ParameterError>([&] { simulation.setCommand(command, 600000000); }), "0.500000 s");
  EXPECT_EQ(simulation.commands().refused(), 2U);
  EXPECT_NO_THROW(simulation.setCommand(command, 400000000));
  EXPECT_NO_THROW(simulation.setCommand(JointCommand(), 0)) << "an empty command is an acknowledgement";
  Simulation patient = fixture::panLift("command_timeout_s: 0");
  patient.step(500);
  EXPECT_NO_THROW(patient.setCommand(command, 0));
}

TEST(SimulationRefusals, ATwistOfARobotThatDoesNotDriveIsCounted) {
  Simulation simulation = fixture::panLift();
  const std::string said = messageOf<ArasError>([&] { simulation.setTwist(Twist::Zero(), ""); });
  EXPECT_HAS(said, "sim/base: driven");
  EXPECT_EQ(simulation.commands().refused(), 1u);
  EXPECT_EQ(simulation.commands().lastRefusal(), said);
}

}  // namespace
}  // namespace aras_visual_servo_sim::simulation_refusals_test
