// Lenses whose polynomial folds over inside the image, which Gazebo draws through.
#include <gtest/gtest.h>

#include "aras_visual_servo_sim/camera/camera_tags.hpp"
#include "aras_visual_servo_sim/config/errors.hpp"
#include "aras_visual_servo_sim/robot/urdf_loader.hpp"
#include "aras_visual_servo_sim/simulation/simulation.hpp"

namespace aras_visual_servo_sim::folding_lens_test {
namespace {

// r (1 + k1 r^2 + k2 r^4 + k3 r^6) grows up to about 1.09, where it is 0.733: half the width of the image is 0.694,
// half its diagonal 0.867.
constexpr double kFold = 1.09, kFoldPlace = 0.01;  // findLensRadius goes in steps of 0.2 %, and stays two behind

RobotModel robotWithLens(const std::string& k2) {
  return loadRobotModel(R"(<robot name="r"><link name="eye"/><gazebo reference="eye"><sensor type="camera" name="s">
    <update_rate>20</update_rate><camera><horizontal_fov>1.21</horizontal_fov>
    <image><width>64</width><height>48</height></image><clip><near>0.1</near><far>9</far></clip>
    <distortion><k1>-0.41464</k1><k2>)" +
                            k2 + R"(</k2><k3>-0.104</k3><p1>0</p1><p2>0</p2></distortion></camera>
    <plugin name="p" filename="libgazebo_ros_camera.so"><cameraName>c</cameraName></plugin></sensor></gazebo></robot>)",
                        "test.urdf");
}

std::string warningsOf(RobotModel model, bool as_gazebo) {
  std::string text;
  model.warnings.clear();
  camerasFromTags(model, model.warnings, as_gazebo);
  for (const std::string& warning : model.warnings) text += warning + "\n";
  return text;
}

TEST(FoldingLens, IsDrawnAsGazeboDoesWithAWarningAndRefusedElsewhere) {
  EXPECT_NE(warningsOf(robotWithLens("0.2407"), true).find("camera 'c': <distortion>: the lens folds over"),
            std::string::npos);
  EXPECT_EQ(warningsOf(robotWithLens("0.6"), true).find("folds over"), std::string::npos) << "this one does not";
  RobotModel model = robotWithLens("0.2407");
  const CameraConfig strict = camerasFromTags(model, model.warnings, false).at(0);
  EXPECT_THROW(CameraModel{strict}, ParameterError);
}

TEST(FoldingLens, ShowsBeyondTheFoldWhatIsNearestToIt) {
  RobotModel model = robotWithLens("0.2407");
  const CameraModel camera(camerasFromTags(model, model.warnings, true).at(0));
  const Eigen::Vector3d corner = camera.unproject(-0.5, -0.5), within = camera.unproject(-0.5, 23.5);
  EXPECT_NEAR(corner.head<2>().norm(), kFold, kFoldPlace);
  EXPECT_NEAR(corner.y() / corner.x(), 48.0 / 64.0, 1e-12) << "in the direction of the corner";
  EXPECT_LT(within.head<2>().norm(), kFold - kFoldPlace);
  const Eigen::Vector2d back = camera.toPixel(within.x(), within.y());
  EXPECT_NEAR(back.x(), -0.5, 1e-9) << "what the lens does reach is as exact as ever";
}

TEST(FoldingLens, ASimulationDrawsThroughIt) {
  for (const char* renderer : {"opengl", "coverage"}) {
    const YAML::Node config = YAML::Load("{compatibility: gazebo, tag_renderer: " + std::string(renderer) +
                                         ", scene: {solids: [{name: wall, box_m: [0.1, 20, 20], position_m: [2, 0, 0],"
                                         " color_rgb: [255, 0, 0]}]}}");
    Simulation simulation(robotWithLens("0.2407"), SimulationConfig::fromYaml(config), YAML::Node());
    const Image& image = simulation.render(0);
    EXPECT_GT(image.pixel(32, 24)[0], 2 * image.pixel(32, 24)[2]) << renderer << ": the wall in the middle";
    EXPECT_GT(image.pixel(0, 24)[0], 2 * image.pixel(0, 24)[2]) << renderer << ": and at the edge";
  }
}

}  // namespace
}  // namespace aras_visual_servo_sim::folding_lens_test
