// Frames of several cameras that are drawn at the same time: the same as one after another.
#include <gtest/gtest.h>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "aras_visual_servo_sim/robot/urdf_loader.hpp"
#include "aras_visual_servo_sim/simulation/simulation.hpp"

namespace aras_visual_servo_sim::take_frames_test {
namespace {

CameraConfig cameraOf(const std::string& name, const std::string& renderer, int side) {
  CameraConfig camera;
  camera.name = name;
  camera.frame = "bob";
  camera.width = camera.height = side;
  camera.horizontal_fov_rad = 1.0;
  camera.rate_hz = 50.0;
  camera.encoding = "rgb8";
  camera.renderer = renderer;
  camera.noise_stddev = 2.0;
  return camera;
}

/** Two large cameras of OpenGL, one with latency, one that blurs, one of coverage, and a small one. */
std::unique_ptr<Simulation> make() {
  SimulationConfig config;
  config.cameras = {cameraOf("gl", "opengl", 400), cameraOf("late", "opengl", 400), cameraOf("blurred", "opengl", 400),
                    cameraOf("coverage", "coverage", 400), cameraOf("small", "coverage", 40)};
  config.cameras[1].latency_s = 0.02;
  config.cameras[2].exposure_s = 0.01;
  config.scene = SceneConfig::fromYaml(YAML::Load(
      "{solids: [{name: ball, sphere_m: 0.1, position_m: [0.1, 0.1, 1.0]}, {name: box, box_m: [0.1, 0.1, 0.1], "
      "position_m: [-0.2, 0.1, 1.0]}]}"));
  return std::make_unique<Simulation>(loadRobotModelFile(ARAS_SIM_TEST_DIR "/urdf/pendulum.urdf"), config,
                                      YAML::Node());
}

TEST(TakeFrames, AreThoseOfOneAfterAnotherWithTheSameRunHash) {
  const auto together = make(), in_turn = make();
  for (int k = 0; k < 3; ++k) {
    std::vector<FrameWanted> frames;
    for (int camera = 0; camera < 5; ++camera) {
      if (together->cameras()[camera].frameDue(together->ticks())) frames.push_back({camera, true, camera != 4});
    }
    ASSERT_EQ(frames.size(), k == 0 ? 4u : 5u);  // the first of the late one is on its way
    together->takeFrames(frames);
    for (const FrameWanted& frame : frames) {
      ASSERT_FALSE(frame.failed);
      in_turn->takeFrame(frame.camera);
      EXPECT_EQ(in_turn->render(frame.camera).data, together->cameras()[frame.camera].image.data) << frame.camera;
      if (!frame.geometry) continue;
      EXPECT_EQ(in_turn->renderGeometry(frame.camera).ids, together->cameras()[frame.camera].geometry.ids);
    }
    EXPECT_EQ(together->runHash(), in_turn->runHash());
    together->step(20);
    in_turn->step(20);
  }
}

TEST(TakeFrames, AreRefusedWithoutAFrameThatIsDue) {
  const auto simulation = make();
  const std::string before = simulation->runHash();
  std::vector<FrameWanted> frames{{0}, {1}};  // that of the late camera comes later
  EXPECT_THROW(simulation->takeFrames(frames), ParameterError);
  EXPECT_TRUE(simulation->cameras()[0].frameDue(0));
  EXPECT_EQ(simulation->runHash(), before);
}

}  // namespace
}  // namespace aras_visual_servo_sim::take_frames_test
