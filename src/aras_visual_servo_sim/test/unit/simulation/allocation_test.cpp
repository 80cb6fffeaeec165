// What is done again and again allocates nothing once it has been done: no jitter, and memory that does not grow.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "aras_visual_servo_sim/render/coverage_renderer.hpp"
#include "tools/allocations.hpp"
#include "tools/pan_lift.hpp"

namespace aras_visual_servo_sim::allocation_test {
namespace {

constexpr int kWarmUp = 200;  // steps: set-points, stops and friction have been met

/** The arm with a PID on each joint, moving. */
std::unique_ptr<MultibodyWorld> movingArm() {
  WorldConfig config;
  const RobotModel model = loadRobotModelFile(ARAS_SIM_TEST_DIR "/urdf/six_joint_arm.urdf");
  for (const std::string& joint : model.joint_names) {
    ControllerConfig controller;
    controller.name = controller.joint = joint;
    controller.gains = PidGains{2000.0, 50.0, 100.0, -100.0, 100.0, false};
    config.controllers.push_back(controller);
  }
  return std::make_unique<MultibodyWorld>(model, config);
}

TEST(Allocation, TheCounterCounts) {
  EXPECT_GT(allocationsOf([] { std::make_unique<std::string>(100, 'x'); }), 1u);
  EXPECT_GT(allocationsOf([] { Eigen::VectorXd::Zero(100).eval(); }), 0u);
  EXPECT_EQ(allocationsOf([] {}), 0u);
}

TEST(Allocation, APhysicsStepMakesNone) {
  const auto arm = movingArm();
  MultibodyWorld& world = *arm;
  JointCommand command;
  for (const std::string& joint : world.model().joint_names) command.position[joint] = 0.3;
  world.setCommand(command);
  world.step(kWarmUp);
  EXPECT_EQ(allocationsOf([&] { world.step(1000); }), 0u);
}

TEST(Allocation, ASimulationsStepMakesNoneBetweenFrames) {
  Simulation simulation = fixture::panLift();
  simulation.stepToImage("camera");
  simulation.step(1);
  EXPECT_EQ(allocationsOf([&] { simulation.step(10); }), 0u);
}

/** A flat target on a board over a picture; the camera moves, and its view is filled by the picture or has its border
 * in it. */
TEST(Allocation, AFrameOfFlatModelsMakesNone) {
  for (const char* encoding : {"mono8", "rgb8"}) {
    CameraConfig config;
    config.width = 64;
    config.height = 48;
    config.horizontal_fov_rad = 1.2;
    config.encoding = encoding;
    for (const char* lens : {"none", "plumb_bob", "equidistant"}) {
      config.distortion_model = lens;
      config.distortion.assign(std::string(lens) == "none" ? 0 : 5, 0.0);
      if (std::string(lens) == "equidistant") config.distortion.resize(4);
      if (std::string(lens) == "plumb_bob") config.distortion[0] = -0.2;
      const CameraModel camera(config);
      Scene scene;
      const Polygon triangle{{-0.1, -0.1}, {0.1, -0.1}, {0.0, 0.2}};
      const auto texture = std::make_shared<Texture>("grey", 4, 4, std::vector<std::uint8_t>(48, 90));
      scene.models.emplace_back("photo", std::vector<Polygon>{}, Rgb{}, std::nullopt,
                                PlanarModel::Picture{texture, {0.8, 0.6}});
      scene.models.emplace_back("target", std::vector<Polygon>{triangle}, Rgb{20, 20, 20},
                                PlanarModel::Board{{0.4, 0.4}, {250, 240, 230}});
      scene.models.back().X_WM.p.z() = 0.05;
      CoverageRenderer renderer;
      Image image;
      const auto pass = [&] {
        for (int k = 0; k < 40; ++k) {
          const Eigen::Quaterniond down(Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitX()));
          const Eigen::AngleAxisd tilt(0.005 * k, Eigen::Vector3d(0.6, 0.8, 0.0));
          renderer.render(camera, {{0.01 * k, 0.005 * k, 0.5}, down * tilt}, scene, image);
        }
      };
      pass();
      EXPECT_EQ(allocationsOf(pass), 0u) << encoding << ", lens " << lens;
    }
  }
}

}  // namespace
}  // namespace aras_visual_servo_sim::allocation_test
