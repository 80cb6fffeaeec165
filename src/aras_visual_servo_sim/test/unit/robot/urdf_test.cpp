#include "aras_visual_servo_sim/config/errors.hpp"
#include "tools/physics_tools.hpp"

namespace aras_visual_servo_sim::urdf_test {
namespace {

/** two_link_full.urdf with one thing changed. */
std::string broken(const std::string& from, const std::string& to) {
  return replaced(readUrdf("two_link_full.urdf"), from, to);
}

std::string refusal(const std::string& urdf) {
  return messageOf<ModelError>([&] { modelOf(urdf); });
}

TEST(UrdfLoader, ReadsEveryElement) {
  const RobotModel model = modelOf(readUrdf("two_link_full.urdf"));
  EXPECT_EQ(model.name, "two_link");
  EXPECT_EQ(model.joint_names, (std::vector<std::string>{"a_slide", "b_swing"}));  // sorted, not in the file's order
  const Joint& swing = model.movingJoint(model.jointIndex("b_swing"));
  EXPECT_EQ(swing.type, JointType::kRevolute);
  EXPECT_TRUE(swing.axis.isApprox(Eigen::Vector3d::UnitY()));
  EXPECT_EQ(swing.limits.lower, -1.0);
  EXPECT_EQ(swing.limits.upper, 2.0);
  EXPECT_EQ(swing.limits.effort, 30.0);
  EXPECT_EQ(swing.limits.velocity, 4.0);
  EXPECT_EQ(swing.damping, 0.7);
  EXPECT_EQ(swing.friction, 0.9);
  EXPECT_TRUE(swing.X_PJ.q.isApprox(quaternionFromRpy({0.1, 0.2, 0.3})));
  EXPECT_EQ(swing.hardware_interfaces, std::vector<std::string>{"EffortJointInterface"});
  EXPECT_EQ(model.movingJoint(0).hardware_interfaces, std::vector<std::string>{"PositionJointInterface"});
  const Link& upper = model.links[model.linkIndex("upper")];
  EXPECT_EQ(upper.mass_kg, 1.5);
  EXPECT_EQ(upper.inertia_kg_m2(0, 2), 0.002);
  EXPECT_TRUE(upper.com_m.isApprox(Eigen::Vector3d(0.0, 0.0, -0.2)));
  ASSERT_EQ(upper.visuals.size(), 1u);
  EXPECT_EQ(upper.visuals[0].geometry.size_m, Eigen::Vector3d(0.1, 0.2, 0.4));
  EXPECT_TRUE(upper.visuals[0].has_color);
  const auto& visuals = model.links[model.linkIndex("lower")].visuals;
  ASSERT_EQ(visuals.size(), 3u);
  EXPECT_EQ(visuals[0].geometry.type, Geometry::Type::kCylinder);
  EXPECT_EQ(visuals[1].geometry.type, Geometry::Type::kSphere);
  EXPECT_EQ(visuals[2].geometry.filename, "package://a/b.stl");
  EXPECT_EQ(visuals[2].geometry.scale, Eigen::Vector3d(1, 2, 3));
}

TEST(UrdfLoader, ReadsTheCameraTag) {
  const RobotModel model = modelOf(readUrdf("two_link_full.urdf"));
  ASSERT_EQ(model.cameras.size(), 1u);
  const CameraTag& camera = model.cameras[0];
  EXPECT_EQ(camera.link, "camera");
  EXPECT_EQ(camera.camera_name, "camera");
  EXPECT_EQ(camera.frame, "camera_optical_frame");
  EXPECT_EQ(camera.width, 320);
  EXPECT_EQ(camera.update_rate_hz, 30.0);
  EXPECT_EQ(camera.distortion, (std::vector<double>{-0.3, 0.1, 0.0, 0.0, 0.0}));
}

TEST(UrdfLoader, TurnsAnInertialFrameIntoTheLinkFrame) {
  const std::string urdf = broken("<origin xyz=\"0 0 -0.2\" rpy=\"0 0 0\"/>\n      <mass",
                                  "<origin xyz=\"0 0 -0.2\" rpy=\"0 0 1.5707963267948966\"/>\n      <mass");
  const Link upper = modelOf(urdf).links[1];
  ASSERT_EQ(upper.name, "upper");
  const double kRounding = 1e-16;  // cos of the nearest double to pi / 2, times the moments
  EXPECT_NEAR(upper.inertia_kg_m2(0, 0), 0.03, kRounding);
  EXPECT_NEAR(upper.inertia_kg_m2(1, 1), 0.02, kRounding);
  EXPECT_NEAR(upper.inertia_kg_m2(0, 1), -0.001, kRounding);
  EXPECT_NEAR(upper.inertia_kg_m2(0, 2), -0.003, kRounding);
}

TEST(UrdfLoader, WarnsOfWhatItIgnores) {
  const std::string urdf = broken("<link name=\"camera\"/>", "<link name=\"camera\"><odour/></link><mystery/>");
  std::string all;
  const RobotModel model = modelOf(urdf);
  for (const auto& warning : model.warnings) all += warning + "\n";
  EXPECT_HAS(all, "<odour>: link 'camera': ignored");
  EXPECT_HAS(all, "<mystery>: ignored");
  EXPECT_HAS(all, "<collision> shapes count only for what sim/contacts names");
}

TEST(UrdfLoader, WarnsOfImpossiblePrincipalMoments) {
  const std::string urdf =
      broken("ixx=\"0.002\" iyy=\"0.003\" izz=\"0.004\"", "ixx=\"0.002\" iyy=\"0.003\" izz=\"0.04\"");
  std::string all;
  const RobotModel model = modelOf(urdf);
  for (const auto& warning : model.warnings) all += warning + "\n";
  EXPECT_HAS(all, "link 'lower': principal moments break the triangle inequality");
}

TEST(UrdfLoader, FixedJointsKeepFramesThatCanBeAsked) {
  MultibodyWorld world(modelOf(readUrdf("two_link_full.urdf")), weightless());
  const Pose X = world.linkPose("lower").inverse() * world.linkPose("camera");
  EXPECT_LT((X.p - Eigen::Vector3d(0.0, 0.01, 0.02)).norm(), 1e-15);  // a few eps of coordinates near 1
}

TEST(UrdfLoader, FramesWithoutMassAndPointMassesAreAllowedWhereOthersMove) {
  const RobotModel model =
      modelOf(broken("<link name=\"camera\"/>",
                     "<link name=\"camera\"><inertial><mass value=\"0\"/><inertia ixx=\"0\" ixy=\"0\" "
                     "ixz=\"0\" iyy=\"0\" iyz=\"0\" izz=\"0\"/></inertial></link>"));
  EXPECT_EQ(model.links[model.linkIndex("camera")].mass_kg, 0.0);
  std::string urdf = broken("ixx=\"0.002\" iyy=\"0.003\" izz=\"0.004\"", "ixx=\"0\" iyy=\"0\" izz=\"0\"");
  MultibodyWorld(modelOf(urdf), weightless()).step(10);  // it slides: its mass is enough
  urdf = replaced(readUrdf("slider.urdf"), "mass value=\"3.0\"", "mass value=\"0\"");
  EXPECT_HAS(messageOf<ModelError>([&] { MultibodyWorld(modelOf(urdf), WorldConfig{}); }),
             "joint 'slide': inertia it moves is 0, must be > 0");
}

struct BadCase {
  const char *what, *from, *to, *message;
};

void PrintTo(const BadCase& bad, std::ostream* out) { *out << bad.what; }

const BadCase kBadCases[] = {
    {"malformed XML", "</robot>", "", "malformed XML"},
    {"missing child link", "<child link=\"lower\"/>", "<child link=\"nowhere\"/>",
     "<child>: joint 'a_slide': child link is 'nowhere', must be a <link> of this file"},
    {"missing parent element", "<parent link=\"upper\"/>", "", "joint 'a_slide': <parent link=...> is missing"},
    {"zero velocity limit", "effort=\"30\" velocity=\"4\"", "effort=\"30\" velocity=\"0\"",
     "test.urdf:34: <limit>: joint 'b_swing': velocity limit is 0, must be > 0"},
    {"negative velocity limit", "velocity=\"2\"", "velocity=\"-1\"",
     "joint 'a_slide': velocity limit is -1, must be > 0"},
    {"negative effort limit", "effort=\"50\"", "effort=\"-50\"", "joint 'a_slide': effort limit is -50, must be >= 0"},
    {"lower above upper", "lower=\"-1.0\"", "lower=\"2.5\"",
     "joint 'b_swing': lower limit is 2.5, must be <= the upper one, 2"},
    {"no limit", "<limit lower=\"-0.1\" upper=\"0.3\" effort=\"50\" velocity=\"2\"/>", "",
     "joint 'a_slide': <limit> is missing"},
    {"inertia not positive definite", "ixy=\"0.001\"", "ixy=\"0.1\"", "link 'upper': inertia has the principal moment"},
    {"negative inertia", "ixx=\"0.002\"", "ixx=\"-0.002\"", "link 'lower': inertia has the principal moment -0.002"},
    {"negative mass", "<mass value=\"0.5\"/>", "<mass value=\"-1\"/>", "link 'lower': mass is -1, must be >= 0"},
    {"NaN mass", "<mass value=\"0.5\"/>", "<mass value=\"nan\"/>",
     "link 'lower': value is 'nan', must be a finite number"},
    {"infinite origin", "xyz=\"0 0 -0.4\"", "xyz=\"0 0 inf\"", "joint 'a_slide': xyz is '0 0 inf', must be 3 finite"},
    {"two numbers for three", "xyz=\"0 0 -0.4\"", "xyz=\"0 0\"", "joint 'a_slide': xyz is '0 0', must be 3 finite"},
    {"words for numbers", "damping=\"0.7\"", "damping=\"some\"", "joint 'b_swing': damping is 'some'"},
    {"negative damping", "damping=\"0.7\"", "damping=\"-0.7\"", "joint 'b_swing': damping is -0.7, must be >= 0"},
    {"negative friction", "friction=\"0.9\"", "friction=\"-1\"", "joint 'b_swing': friction is -1, must be >= 0"},
    {"static friction below friction", "friction=\"0.9\"",
     "friction=\"0.9\" static_friction=\"0.8\" stribeck_velocity=\"1\"",
     "joint 'b_swing': static_friction is 0.8, must be >= the friction, 0.9"},
    {"static friction alone", "friction=\"0.9\"", "friction=\"0.9\" static_friction=\"1\"",
     "joint 'b_swing': stribeck_velocity is missing, must stand beside static_friction"},
    {"no Stribeck velocity", "friction=\"0.9\"", "friction=\"0.9\" static_friction=\"1\" stribeck_velocity=\"0\"",
     "joint 'b_swing': stribeck_velocity is 0, must be > 0"},
    {"unknown joint type", "name=\"a_slide\" type=\"prismatic\"", "name=\"a_slide\" type=\"sliding\"",
     "joint 'a_slide': type is 'sliding', must be revolute, continuous, prismatic, fixed or"},
    {"floating joint", "name=\"a_slide\" type=\"prismatic\"", "name=\"a_slide\" type=\"floating\"",
     "joint 'a_slide': type is 'floating' below the root link 'world'"},
    {"planar joint", "name=\"a_slide\" type=\"prismatic\"", "name=\"a_slide\" type=\"planar\"",
     "joint 'a_slide': type is 'planar', which is not simulated"},
    {"zero axis", "xyz=\"0 2 0\"", "xyz=\"0 0 0\"", "joint 'b_swing': axis is '0 0 0', must not be zero"},
    {"link name twice", "<link name=\"camera\"/>", "<link name=\"upper\"/>", "link 'upper': name is used twice"},
    {"joint name twice", "name=\"a_slide\" type", "name=\"b_swing\" type", "joint 'b_swing': name is used twice"},
    {"link without name", "<link name=\"camera\"/>", "<link/>", "<link>: name is missing"},
    {"two roots", "<link name=\"camera\"/>", "<link name=\"camera\"/><link name=\"stray\"/>",
     "found 2 root links ('stray', 'world'), must be one"},
    {"two parents", "<child link=\"camera\"/>", "<child link=\"upper\"/>",
     "joint 'mount': child link 'upper' has another parent already"},
    {"loop", "<parent link=\"world\"/>", "<parent link=\"camera\"/>", "is in a loop of joints"},
    {"transmission of an unknown joint", "<joint name=\"b_swing\"><hard", "<joint name=\"nothing\"><hard",
     "transmission acts on joint 'nothing', must be a <joint> of this file"},
    {"camera on an unknown link", "<gazebo reference=\"camera\">", "<gazebo reference=\"nothing\">",
     "reference is 'nothing', must be a <link> of this file"},
    {"unknown shape", "<sphere radius=\"0.06\"/>", "<torus radius=\"0.06\"/>", "link 'lower': shape is 'torus'"},
    {"negative radius", "<sphere radius=\"0.06\"/>", "<sphere radius=\"-0.06\"/>", "radius is -0.06, must be > 0"},
    {"a place beyond any hall", "xyz=\"0 0 -0.4\"", "xyz=\"0 0 1e5\"",
     "joint 'a_slide': xyz is 100000, must be from -10000 to 10000"},
    {"an angle of many turns", "rpy=\"0.1 0.2 0.3\"", "rpy=\"0.1 -1e5 0.3\"",
     "joint 'b_swing': rpy is -100000, must be from -1000 to 1000"},
    {"a mass beyond any crane", "<mass value=\"0.5\"/>", "<mass value=\"1e300\"/>",
     "link 'lower': mass is 1e+300, must be"},
    {"an inertia beyond any", "ixx=\"0.002\"", "ixx=\"1e13\"",
     "link 'lower': ixx is 1e+13, must be from -1e+12 to 1e+12"},
    {"a shape beyond any hall", "<sphere radius=\"0.06\"/>", "<sphere radius=\"1e5\"/>",
     "link 'lower': radius is 100000, must be from -10000 to 10000"},
    {"a mesh that is blown up", "scale=\"1 2 3\"", "scale=\"1 2 1e300\"",
     "link 'lower': scale is 1e+300, must be from"},
    {"damping beyond any", "damping=\"0.7\"", "damping=\"1e10\"",
     "joint 'b_swing': damping is 10000000000, must be from"},
    {"an image wider than any", "<width>320</width>", "<width>1e300</width>",
     "<width>: value is 1e300, must be >= 1 and <= 16384"},
    {"robot without name", "<robot name=\"two_link\">", "<robot>", "urdfdom refuses"},
};

class UrdfLoaderBadCases : public testing::TestWithParam<BadCase> {};

TEST_P(UrdfLoaderBadCases, IsRefusedByNameValueAndWhatIsAllowed) {
  const BadCase& bad = GetParam();
  testing::internal::CaptureStderr();
  const std::string message = refusal(broken(bad.from, bad.to));
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "") << bad.what;
  EXPECT_HAS(message, "test.urdf");
  EXPECT_HAS(message, bad.message);
}

INSTANTIATE_TEST_SUITE_P(EachAttribute, UrdfLoaderBadCases, testing::ValuesIn(kBadCases));

TEST(UrdfLoader, AJointThatMovesNoMassIsRefused) {
  std::string urdf = replaced(readUrdf("slider.urdf"), "<link name=\"block\">", "<link name=\"block\"/><!--");
  urdf = replaced(urdf, "</inertial>\n  </link>", "-->");
  EXPECT_HAS(messageOf<ModelError>([&] { MultibodyWorld(modelOf(urdf), WorldConfig{}); }),
             "joint 'slide': inertia it moves is 0, must be > 0");
}

TEST(UrdfLoader, ADocumentWithoutARobotIsRefused) {
  EXPECT_HAS(refusal("<automaton/>"), "test.urdf: found no <robot> element");
  EXPECT_HAS(refusal("<robot name=\"nobody\"/>"), "<robot>: found no <link>, must have at least one");
}

TEST(UrdfLoader, AFileThatIsNotThereIsNamed) {
  EXPECT_HAS(messageOf<ModelError>([] { loadRobotModelFile("/nowhere/a.urdf"); }),
             "URDF '/nowhere/a.urdf': cannot be read: No such file or directory");
  EXPECT_HAS(messageOf<ModelError>([] { loadRobotModelFile("/"); }), "found a folder, allowed a regular file");
}

TEST(UrdfLoader, AChainWithoutEndIsRefused) {
  std::string chain = "<robot name='chain'><link name='l0'/>";
  for (int k = 1; k <= 20000; ++k) {
    const std::string parent = "l" + std::to_string(k - 1), child = "l" + std::to_string(k);
    chain += "<link name='" + child + "'/><joint name='j" + child + "' type='fixed'><parent link='" + parent +
             "'/><child link='" + child + "'/></joint>";
  }
  EXPECT_HAS(refusal(chain + "</robot>"), "found 20001 links, allowed <= 1000");
  std::string nested;
  for (int k = 0; k < 100000; ++k) nested += "<a>";
  EXPECT_HAS(refusal("<robot name='deep'>" + nested), "malformed XML");
  EXPECT_HAS(refusal("<robot/>" + std::string(5000000, ' ')), "found 5000008 bytes, allowed <= 4194304");
}

TEST(RobotModel, UnknownNamesListTheKnownOnes) {
  const RobotModel model = modelOf(readUrdf("two_link_full.urdf"));
  EXPECT_HAS(messageOf<UnknownNameError>([&] { model.jointIndex("mount"); }), "allowed: a_slide, b_swing");
  EXPECT_HAS(messageOf<UnknownNameError>([&] { model.linkIndex("hand"); }), "link 'hand'");
}

// Whether this name is one depends on TinyXML's version: where urdfdom reads it as it stands, the joints are there.
TEST(UrdfLoader, ANameThatUrdfdomReadsOtherwiseIsRefused) {
  const std::string head =
      "<robot name='r'><link name='a'/><link name='b'/><link name='c'/><joint name='j' type='prismatic'>"
      "<parent link='a'/><child link='b'/><limit lower='-1' upper='1' effort='9' velocity='2'/></joint>";
  const auto with = [&](const std::string& name) {
    return head + "<joint name='" + name +
           "' type='continuous'><parent link='b'/><child link='c'/><mimic joint='j'/></joint></robot>";
  };
  try {
    EXPECT_EQ(modelOf(with("k\x88&\x88\x88\x88k")).dofs(), 2);
  } catch (const std::exception& refused) {
    EXPECT_HAS(std::string(refused.what()), "found a name that urdfdom reads otherwise, must be plain text");
  }
  for (const std::string name : {"k", "k &amp; l", "\xc3\xa4", "k/1"}) EXPECT_EQ(modelOf(with(name)).dofs(), 2) << name;
}

}  // namespace
}  // namespace aras_visual_servo_sim::urdf_test
