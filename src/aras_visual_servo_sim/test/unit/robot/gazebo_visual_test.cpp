// <visual> tags about the looks of a link.
#include <gtest/gtest.h>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "aras_visual_servo_sim/robot/urdf_loader.hpp"

namespace aras_visual_servo_sim::gazebo_visual_test {
namespace {

RobotModel robotWith(const std::string& tags) {
  return loadRobotModel(R"(<robot name="r"><link name="a">
    <visual name="first"><geometry><sphere radius="1"/></geometry></visual>
    <visual name="second"><geometry><sphere radius="2"/></geometry></visual></link>
    <gazebo reference="a">)" +
                            tags + "</gazebo></robot>",
                        "test.urdf");
}

std::string allOf(const std::vector<std::string>& lines) {
  std::string text;
  for (const std::string& line : lines) text += line + "\n";
  return text;
}

TEST(GazeboVisual, PaintsTheVisualOfItsNameElseAll) {
  const std::string red = "<material><script><name>Gazebo/Red</name></script></material></visual>";
  const RobotModel one = robotWith("<visual name='second'>" + red), all = robotWith("<visual>" + red);
  EXPECT_FALSE(one.links[0].visuals[0].has_color);
  EXPECT_DOUBLE_EQ(one.links[0].visuals[1].color.g, 0.0);
  EXPECT_TRUE(all.links[0].visuals[0].has_color && all.links[0].visuals[1].has_color);
}

TEST(GazeboVisual, ColoursReplaceThoseOfTheNamedMaterial) {
  const RobotModel robot =
      robotWith(R"(<visual name="first"><transparency>0.25</transparency><cast_shadows>0</cast_shadows>
    <material><script><name>Gazebo/Grey</name></script><diffuse>0.1 0.2 0.3 1</diffuse><specular>0.5 0.5 0.5</specular>
    <emissive>0 1 0 1</emissive></material></visual>)");
  const Visual& visual = robot.links[0].visuals[0];
  EXPECT_DOUBLE_EQ(visual.color.g, 0.2);
  EXPECT_DOUBLE_EQ(visual.color.a, 0.75);
  EXPECT_DOUBLE_EQ(visual.finish.ambient->r, 0.3) << "of Gazebo/Grey";
  EXPECT_DOUBLE_EQ(visual.finish.specular.r, 0.5);
  EXPECT_DOUBLE_EQ(visual.finish.emissive.g, 1.0);
  EXPECT_EQ(allOf(robot.warnings), "");
}

TEST(GazeboVisual, SaysHowAPictureLiesOnAShape) {
  const RobotModel robot = robotWith(
      "<visual name='second'><material><texture_transform>2 0 -0.5  0 4 1e1</texture_transform></material></visual>");
  const std::vector<Visual>& visuals = robot.links[0].visuals;
  TextureTransform expected;
  expected << 2.0, 0.0, -0.5, 0.0, 4.0, 10.0;
  EXPECT_FALSE(visuals[0].texture_transform);
  ASSERT_TRUE(visuals[1].texture_transform);
  EXPECT_EQ(*visuals[1].texture_transform, expected);
  for (const char* text : {"", "1 0 0 0 1", "1 0 0 0 1 0 0", "1 0 0 0 nan 0", "1 0 0 0 1 x"}) {
    const std::string tag = std::string("<texture_transform>") + text + "</texture_transform>";
    EXPECT_THROW(robotWith("<visual><material>" + tag + "</material></visual>"), ModelError) << text;
  }
}

TEST(GazeboVisual, WhatIsNotUsedIsNamedAndWhatIsNoColourRefused) {
  const std::string warnings = allOf(robotWith(R"(<visual><laser_retro>1</laser_retro><material><shader>1</shader>
    <script><name>Own/Marble</name></script></material></visual>)")
                                         .warnings);
  for (const char* name : {"laser_retro", "shader", "Own/Marble"}) {
    EXPECT_NE(warnings.find(name), std::string::npos) << warnings;
  }
  EXPECT_THROW(robotWith("<visual><material><diffuse>red</diffuse></material></visual>"), ModelError);
  EXPECT_THROW(robotWith("<visual><material><ambient>1 nan 0</ambient></material></visual>"), ModelError);
}

}  // namespace
}  // namespace aras_visual_servo_sim::gazebo_visual_test
