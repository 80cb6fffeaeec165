#include "aras_visual_servo_sim/camera/camera_tags.hpp"

#include <gtest/gtest.h>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "aras_visual_servo_sim/robot/urdf_loader.hpp"
#include "aras_visual_servo_sim/simulation/simulation.hpp"

namespace aras_visual_servo_sim::camera_tags_test {
namespace {

RobotModel robotWithCamera(const std::string& format) {
  RobotModel robot;
  CameraTag tag;
  tag.link = "camera_link";
  tag.camera_name = "/eye";
  tag.frame = "eye_optical_frame";
  tag.format = format;
  tag.width = 64;
  tag.height = 48;
  tag.update_rate_hz = 25.0;
  tag.horizontal_fov_rad = 1.2;
  tag.distortion = {0.1, 0.2, 0.3, 0.4, 0.5};
  robot.cameras.push_back(tag);
  return robot;
}

/** A sensor on a link, the optical frame it needs on a link beside it, turned as REP 103 has it. */
std::string urdfWith(const std::string& sensor, const std::string& rpy = "-1.5707963267948966 0 -1.5707963267948966") {
  return R"(<robot name="eye"><link name="world"/><link name="camera_link"/><link name="eye_optical_frame"/>
    <joint name="a" type="fixed"><parent link="world"/><child link="camera_link"/><origin xyz="0.1 0.2 0.3" rpy="0 0.4 0.7"/></joint>
    <joint name="b" type="fixed"><parent link="camera_link"/><child link="eye_optical_frame"/><origin rpy=")" +
         rpy + R"("/></joint><gazebo reference="camera_link"><sensor type="camera" name="s">)" + sensor +
         "</sensor></gazebo></robot>";
}

const char* const kCamera = R"(<update_rate>20</update_rate><camera><horizontal_fov>1.2</horizontal_fov>
  <image><width>64</width><height>48</height><format>L8</format></image><clip><near>0.1</near><far>9</far></clip>
  <noise><type>gaussian</type><mean>0.01</mean><stddev>0.02</stddev></noise>)";

std::string plugin(const std::string& keys) {
  return R"(<plugin name="p" filename="libgazebo_ros_camera.so"><cameraName>eye</cameraName>
    <frameName>eye_optical_frame</frameName>)" +
         keys + "</plugin>";
}

struct Reading {
  CameraConfig camera;
  std::string warnings;
};

Reading read(const std::string& urdf) {
  RobotModel model = loadRobotModel(urdf, "test.urdf");
  Reading reading;
  reading.camera = camerasFromTags(model, model.warnings).at(0);
  for (const std::string& warning : model.warnings) reading.warnings += warning + "\n";
  return reading;
}

TEST(CameraTags, BecomeACameraWithTheTagsNumbers) {
  std::vector<std::string> warnings;
  const std::vector<CameraConfig> cameras = camerasFromTags(robotWithCamera("L8"), warnings);
  ASSERT_EQ(cameras.size(), 1U);
  EXPECT_EQ(cameras[0].name, "eye");
  EXPECT_EQ(cameras[0].frame, "eye_optical_frame");
  EXPECT_EQ(cameras[0].width, 64);
  EXPECT_EQ(cameras[0].height, 48);
  EXPECT_EQ(cameras[0].rate_hz, 25.0);
  EXPECT_EQ(*cameras[0].horizontal_fov_rad, 1.2);
  EXPECT_EQ(cameras[0].encoding, "mono8");
  EXPECT_EQ(cameras[0].distortion_model, "plumb_bob");
  EXPECT_EQ(cameras[0].distortion.back(), 0.5);
}

TEST(CameraTags, FormatsAreTheEncodingsOfGazebosPlugin) {
  std::vector<std::string> warnings;
  for (const auto& [format, encoding] : std::map<std::string, std::string>{{"R8G8B8", "rgb8"},
                                                                           {"BGR_INT8", "bgr8"},
                                                                           {"L_INT16", "mono16"},
                                                                           {"L16", "mono16"},
                                                                           {"R16G16B16", "rgb16"},
                                                                           {"RGB_INT16", "rgb16"},
                                                                           {"BAYER_GRBG8", "bayer_grbg8"}}) {
    EXPECT_EQ(camerasFromTags(robotWithCamera(format), warnings).at(0).encoding, encoding);
  }
}

TEST(CameraTags, UnknownImageFormatIsRefused) {
  std::vector<std::string> warnings;
  EXPECT_THROW(camerasFromTags(robotWithCamera("BGR_INT16"), warnings), ModelError);
}

/** Gazebo's own fisheye. */
std::string wideAngle(const std::string& lens) {
  std::string urdf = urdfWith(kCamera + ("<lens>" + lens + "</lens></camera>") + plugin(""));
  const std::string plain = R"(type="camera")";
  return urdf.replace(urdf.find(plain), plain.size(), R"(type="wideanglecamera")");
}

TEST(CameraTags, AWideAngleCameraIsTheEquidistantLens) {
  const Reading reading =
      read(wideAngle("<type>equidistant</type><scale_to_hfov>true</scale_to_hfov>"
                     "<cutoff_angle>1.7</cutoff_angle><env_texture_size>512</env_texture_size>"));
  EXPECT_EQ(reading.warnings, "");
  EXPECT_EQ(reading.camera.distortion_model, "equidistant");
  EXPECT_EQ(reading.camera.cutoff_angle_rad, 1.7);
  EXPECT_NEAR(CameraModel(reading.camera).fx(), 64 / 1.2, 1e-12 * 64);
  EXPECT_EQ(read(wideAngle("<type>equidistant</type>")).camera.cutoff_angle_rad, 1.5707);  // SDF's default
  const Reading farther = read(wideAngle("<type>equidistant</type><cutoff_angle>3.1</cutoff_angle><c1>1</c1>"));
  EXPECT_EQ(farther.camera.cutoff_angle_rad, 2.18);
  EXPECT_NE(farther.warnings.find("<cutoff_angle> 3.1"), std::string::npos) << farther.warnings;
  EXPECT_NE(farther.warnings.find("c1"), std::string::npos) << farther.warnings;
}

TEST(CameraTags, AWideAngleCameraMayHaveAPolynomial) {
  const std::string lens = "<type>equidistant</type><polynomial>0.1 0.02 -0.003 0.0004</polynomial>";
  const Reading reading = read(wideAngle(lens));
  EXPECT_EQ(reading.warnings, "");
  EXPECT_EQ(reading.camera.distortion, (std::vector<double>{0.1, 0.02, -0.003, 0.0004}));
  EXPECT_EQ(reading.camera.distortion_model, "equidistant");
  for (const char* wrong : {"1 2 3", "1 2 3 4 5", "1 2 3 four", ""}) {
    const std::string tag = "<type>equidistant</type><polynomial>" + std::string(wrong) + "</polynomial>";
    EXPECT_THROW(loadRobotModel(wideAngle(tag), "test.urdf"), ModelError) << wrong;
  }
}

TEST(CameraTags, AWideAngleCameraOfAnotherLensIsNamedInAWarning) {
  RobotModel model = loadRobotModel(wideAngle("<type>stereographic</type>"), "test.urdf");
  EXPECT_TRUE(model.cameras.empty());
  ASSERT_EQ(model.warnings.size(), 1U);
  EXPECT_NE(model.warnings[0].find("'stereographic', there is equidistant"), std::string::npos) << model.warnings[0];
}

TEST(CameraTags, NoiseIsOfIntensitiesAndThePlainCameraIsSilent) {
  const Reading reading = read(urdfWith(kCamera + std::string("</camera>") + plugin("<CxPrime>32.5</CxPrime>")));
  EXPECT_EQ(reading.warnings, "");
  EXPECT_DOUBLE_EQ(reading.camera.noise_mean, 2.55);
  EXPECT_DOUBLE_EQ(reading.camera.noise_stddev, 5.1);
  EXPECT_EQ(reading.camera.near_m, 0.1);
  EXPECT_EQ(reading.camera.frame, "eye_optical_frame");
  EXPECT_EQ(reading.camera.mount, "");
}

TEST(CameraTags, CameraInfoIsThatOfGazeboWhereKeysSaySoAndTheImageAgrees) {
  const Reading reading = read(urdfWith(kCamera + std::string("</camera>") + plugin(R"(<Cx>32.5</Cx><Cy>23.5</Cy>
    <focalLength>70</focalLength><hackBaseline>0.07</hackBaseline><distortionK1>-0.1</distortionK1>
    <distortionK2>0.01</distortionK2><distortionK3>0.001</distortionK3><distortionT1>0.002</distortionT1>
    <distortionT2>0.003</distortionT2>)")));
  const CameraModel model(reading.camera);
  EXPECT_EQ(model.K()(0, 0), 70.0);
  EXPECT_EQ(model.K()(0, 2), 32.5);
  EXPECT_EQ(model.K()(1, 2), 23.5);
  EXPECT_DOUBLE_EQ(model.P()(0, 3), -70.0 * 0.07);
  EXPECT_EQ(model.D(), (std::vector<double>{-0.1, 0.01, 0.002, 0.003, 0.001}));
  for (const char* key : {"<focalLength>", "<Cx>", "distortionK1"}) {
    EXPECT_NE(reading.warnings.find(key), std::string::npos) << key;
  }
  EXPECT_EQ(reading.warnings.find("<Cy>"), std::string::npos);  // 23.5 is the middle of 48
}

TEST(CameraTags, AsGazeboCameraInfoIsThePluginsAndTheImageTheSensors) {
  RobotModel robot = loadRobotModel(urdfWith(kCamera + std::string("</camera>") + plugin("")), "test.urdf");
  std::vector<std::string> warnings;
  const CameraModel plain(camerasFromTags(robot, warnings, true).front());
  EXPECT_DOUBLE_EQ(plain.K()(0, 0), 32.0 / std::tan(0.6));
  EXPECT_EQ(plain.K()(0, 2), 32.5);  // (64 + 1) / 2
  EXPECT_EQ(plain.K()(1, 2), 24.5);
  EXPECT_EQ(plain.P()(1, 2), 24.5);
  EXPECT_EQ(plain.cx(), 31.5);  // what it is drawn with
  EXPECT_EQ(plain.cy(), 23.5);
  EXPECT_EQ(plain.D(), std::vector<double>(5, 0.0));
  EXPECT_NE(warnings.back().find("sim/compatibility"), std::string::npos);

  const std::string lens =
      "<distortion><k1>-0.2</k1><k2>0.03</k2><p1>0.001</p1><p2>0.002</p2><k3>0.004</k3></distortion>";
  const std::string keys =
      "<focalLength>70</focalLength><Cx>30</Cx><hackBaseline>0.07</hackBaseline><distortionK1>-0.1</distortionK1>";
  robot = loadRobotModel(urdfWith(kCamera + lens + "</camera>" + plugin(keys)), "test.urdf");
  const CameraModel told(camerasFromTags(robot, warnings, true).front());
  EXPECT_EQ(told.K()(0, 0), 70.0);
  EXPECT_EQ(told.K()(1, 1), 70.0);
  EXPECT_EQ(told.K()(0, 2), 30.0);
  EXPECT_DOUBLE_EQ(told.P()(0, 3), -70.0 * 0.07);
  EXPECT_EQ(told.D(), (std::vector<double>{-0.1, 0.0, 0.0, 0.0, 0.0}));
  EXPECT_EQ(told.config().distortion, (std::vector<double>{-0.2, 0.03, 0.001, 0.002, 0.004}));
  EXPECT_DOUBLE_EQ(told.fx(), 32.0 / std::tan(0.6));
  EXPECT_EQ(told.cx(), 31.5);

  robot = loadRobotModel(urdfWith(kCamera + lens + "</camera>" + plugin("<autoDistortion>true</autoDistortion>")),
                         "test.urdf");
  const CameraModel automatic(camerasFromTags(robot, warnings, true).front());
  EXPECT_EQ(automatic.D(), automatic.config().distortion);
}

TEST(CameraTags, CompatibilityIsOffUnlessAskedFor) {
  EXPECT_FALSE(SimulationConfig::fromYaml(YAML::Load("{}")).gazebo_cameras);
  EXPECT_TRUE(SimulationConfig::fromYaml(YAML::Load("{compatibility: gazebo}")).gazebo_cameras);
  EXPECT_THROW(SimulationConfig::fromYaml(YAML::Load("{compatibility: yes}")), ParameterError);
}

TEST(CameraTags, FocalLengthOfTheFieldIsNoNews) {
  const Reading reading =
      read(urdfWith(kCamera + std::string("</camera>") + plugin("<focalLength>46.774</focalLength>")));
  EXPECT_EQ(reading.warnings, "");
  EXPECT_EQ(reading.camera.horizontal_fov_rad, 1.2);  // 32 / tan(0.6) = 46.7745
}

TEST(CameraTags, SensorsOwnLensIsWhatIsDrawn) {
  const std::string lens =
      "<distortion><k1>-0.2</k1><k2>0.03</k2><p1>0.001</p1><p2>0.002</p2><k3>0.004</k3>"
      "<center>0.5 0.5</center></distortion></camera>";
  const std::vector<double> drawn{-0.2, 0.03, 0.001, 0.002, 0.004};
  const Reading automatic = read(urdfWith(kCamera + lens + plugin("<autoDistortion>true</autoDistortion>")));
  EXPECT_EQ(automatic.camera.distortion, drawn);
  EXPECT_EQ(automatic.warnings, "");
  const Reading other = read(urdfWith(kCamera + lens + plugin("<distortionK1>0.5</distortionK1>")));
  EXPECT_EQ(other.camera.distortion, drawn);
  EXPECT_NE(other.warnings.find("which differ"), std::string::npos);
}

TEST(CameraTags, CameraSitsWhereTheSensorDoesWhateverItsFrameIsCalled) {
  const Reading turned =
      read(urdfWith("<pose>0.01 0.02 0.03 0 0 0.5</pose>" + std::string(kCamera) + "</camera>" + plugin("")));
  EXPECT_EQ(turned.camera.mount, "camera_link");
  EXPECT_EQ(turned.camera.frame, "eye_optical_frame");
  EXPECT_NE(turned.warnings.find("not the optical frame"), std::string::npos);
  constexpr double kRounding = 1e-15;
  const Eigen::Vector3d forward = turned.camera.X_MC.q * Eigen::Vector3d::UnitZ();
  EXPECT_LT((forward - Eigen::Vector3d(std::cos(0.5), std::sin(0.5), 0.0)).norm(), kRounding);
  const Eigen::Vector3d down = turned.camera.X_MC.q * Eigen::Vector3d::UnitY();
  EXPECT_LT((down + Eigen::Vector3d::UnitZ()).norm(), kRounding);
  EXPECT_EQ(turned.camera.X_MC.p, Eigen::Vector3d(0.01, 0.02, 0.03));
  EXPECT_EQ(read(urdfWith(kCamera + std::string("</camera>") + plugin(""), "0 0 0")).camera.mount, "camera_link");
}

TEST(CameraTags, WhatIsNotReadIsWarnedAboutAndMalformedNumbersAreRefused) {
  const Reading reading = read(urdfWith(kCamera + std::string("<depth_camera/></camera><topic>x</topic>") +
                                        plugin("<borderCrop>true</borderCrop><nonsense>1</nonsense>")));
  for (const char* key : {"depth_camera", "topic", "borderCrop", "nonsense"}) {
    EXPECT_NE(reading.warnings.find(key), std::string::npos) << key;
  }
  for (const char* bad : {"<Cx>left</Cx>", "<hackBaseline>nan</hackBaseline>", "<autoDistortion>7</autoDistortion>"}) {
    EXPECT_THROW(read(urdfWith(kCamera + std::string("</camera>") + plugin(bad))), ModelError) << bad;
  }
  EXPECT_THROW(read(urdfWith("<pose>1 2 3</pose>")), ModelError);
}

TEST(GazeboMaterials, PaintEveryVisualOfTheirLinkAndOthersAreWarnedAbout) {
  const auto load = [](const std::string& material) {
    return loadRobotModel(
        "<robot name='r'><link name='a'><visual><geometry><box size='1 1 1'/></geometry><material "
        "name='m'><color rgba='0 1 0 1'/></material></visual></link><gazebo reference='a'><material>" +
            material + "</material></gazebo></robot>",
        "test.urdf");
  };
  const RobotModel orange = load("Gazebo/Orange");
  EXPECT_TRUE(orange.warnings.empty());
  EXPECT_DOUBLE_EQ(orange.links[0].visuals[0].color.g, 0.5088);
  const RobotModel wood = load("Gazebo/Wood");
  ASSERT_EQ(wood.warnings.size(), 1u);
  EXPECT_NE(wood.warnings[0].find("'Gazebo/Wood'"), std::string::npos) << wood.warnings[0];
  EXPECT_DOUBLE_EQ(wood.links[0].visuals[0].color.g, 1.0);
}

TEST(CameraTags, MaterialScriptsOfVisualsAreColoursOrNamedInAWarning) {
  const auto load = [](const std::string& name) {
    return loadRobotModel(
        "<robot name='r'><link name='a'><visual><geometry><box size='1 1 1'/></geometry></visual></link>"
        "<gazebo reference='a'><visual><material><script><uri>file://own.material</uri><name>" +
            name + "</name></script></material></visual></gazebo></robot>",
        "test.urdf");
  };
  EXPECT_DOUBLE_EQ(load("Gazebo/Orange").links[0].visuals[0].color.g, 0.5088);
  EXPECT_TRUE(load("Gazebo/Orange").warnings.empty());
  const RobotModel own = load("Own/Checkers");
  ASSERT_EQ(own.warnings.size(), 1u);
  EXPECT_NE(own.warnings[0].find("'Own/Checkers'"), std::string::npos) << own.warnings[0];
}

TEST(CameraTags, PoseAndTwistOfAnOffsetCameraAreThoseOfItsOwnPoint) {
  CameraConfig config;
  config.name = "eye";
  config.frame = "eye";
  config.mount = "bob";
  config.X_MC = {{0.1, -0.2, 0.3}, quaternionFromRpy({0.3, -0.4, 0.9})};
  config.width = 8;
  config.height = 8;
  config.horizontal_fov_rad = 1.0;
  SimulationConfig simulation_config;
  simulation_config.cameras = {config};
  simulation_config.initial_positions = {{"swing", 0.7}};
  Simulation simulation(loadRobotModelFile(ARAS_SIM_TEST_DIR "/urdf/pendulum.urdf"), simulation_config, YAML::Node());
  simulation.step(200);
  // Over one tick, centred: the error is that of the second difference, about w^2 T^2 / 24 of the velocity.
  const Pose before = simulation.cameraPose(0);
  simulation.step(1);
  const Twist V = simulation.cameraTwist(0);
  const Pose here = simulation.cameraPose(0);
  simulation.step(1);
  const Pose after = simulation.cameraPose(0);
  const Eigen::Vector3d v_C = here.q.conjugate() * ((after.p - before.p) / 0.002);
  EXPECT_GT(V.head<3>().norm(), 0.05);
  EXPECT_LT((v_C - V.head<3>()).norm(), 0.02 * V.head<3>().norm());
  const Eigen::AngleAxisd turn(before.q.conjugate() * after.q);
  EXPECT_LT((here.q.conjugate() * before.q * turn.axis() * turn.angle() / 0.002 - V.tail<3>()).norm(),
            0.02 * V.tail<3>().norm());
}

}  // namespace
}  // namespace aras_visual_servo_sim::camera_tags_test
