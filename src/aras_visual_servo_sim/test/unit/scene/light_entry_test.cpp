// Lights as SDF and as YAML describe them.
#include "aras_visual_servo_sim/scene/light_entry.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "tools/messages.hpp"

namespace aras_visual_servo_sim::light_entry_test {
namespace {

constexpr double kRounding = 1e-12;

const char* const kSun =
    "<light name='sun' type='directional'><cast_shadows>true</cast_shadows><pose>0 0 10 0 0 0</pose>"
    "<diffuse>0.8 0.7 0.6 1</diffuse><specular>0.2 0.1 0.05 1</specular>"
    "<attenuation><range>1000</range><constant>0.9</constant><linear>0.01</linear><quadratic>0.001</quadratic>"
    "</attenuation><direction>-0.5 0.1 -0.9</direction></light>";
const char* const kSpot =
    "<sdf version='1.6'><light name='lamp' type='spot'><pose>1 2 3 0 1.5707963267948966 0</pose>"
    "<spot><inner_angle>0.3</inner_angle><outer_angle>0.9</outer_angle><falloff>2</falloff></spot></light></sdf>";

TEST(SdfLight, SaysWhatALightIs) {
  const Light sun = lightFromSdf(kSun, "test");
  EXPECT_EQ(sun.name, "sun");
  EXPECT_EQ(sun.type, Light::Type::kDirectional);
  EXPECT_TRUE(sun.diffuse.isApprox(Eigen::Vector3d(0.8, 0.7, 0.6), kRounding));
  EXPECT_TRUE(sun.specular.isApprox(Eigen::Vector3d(0.2, 0.1, 0.05), kRounding));
  EXPECT_TRUE(sun.direction_W.isApprox(Eigen::Vector3d(-0.5, 0.1, -0.9), kRounding));
  EXPECT_TRUE(sun.casts_shadows);
  EXPECT_EQ(sun.range_m, 1000.0);
  EXPECT_EQ(sun.constant, 0.9);
  EXPECT_EQ(sun.linear_per_m, 0.01);
  EXPECT_EQ(sun.quadratic_per_m2, 0.001);
}

TEST(SdfLight, HasSdfsDefaultsAndTurnsWithItsPose) {
  const Light lamp = lightFromSdf(kSpot, "test");
  EXPECT_EQ(lamp.type, Light::Type::kSpot);
  EXPECT_TRUE(lamp.position_W.isApprox(Eigen::Vector3d(1, 2, 3), kRounding));
  EXPECT_TRUE(lamp.direction_W.isApprox(-Eigen::Vector3d::UnitX(), 1e-9));  // (0, 0, -1), a quarter turn about y
  EXPECT_TRUE(lamp.diffuse.isOnes());
  EXPECT_TRUE(lamp.specular.isConstant(0.1));
  EXPECT_FALSE(lamp.casts_shadows);
  EXPECT_EQ(lamp.range_m, 10.0);
  EXPECT_EQ(lamp.linear_per_m, 1.0);
  EXPECT_EQ(lamp.inner_angle_rad, 0.3);
  EXPECT_EQ(lamp.outer_angle_rad, 0.9);
  EXPECT_EQ(lamp.falloff, 2.0);
  const std::string bulb = "<light name='b' type='point'><intensity>2</intensity>%</light>";
  EXPECT_TRUE(lightFromSdf(bulb.substr(0, bulb.find('%')) + "</light>", "test").diffuse.isConstant(2.0));
  EXPECT_TRUE(lightFromSdf("<light name='b' type='point'><light_on>0</light_on></light>", "test").diffuse.isZero());
}

TEST(SdfLight, WhatIsIgnoredIsToldWithItsLine) {
  std::vector<std::string> warnings;
  lightFromSdf("<light name='b' type='point'>\n<flicker>1</flicker></light>", "file.world", &warnings);
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_EQ(warnings[0].find("file.world:2: <flicker>"), 0u) << warnings[0];
}

TEST(SdfLight, WhatIsWrongIsNamed) {
  for (const auto& [xml, named] : std::vector<std::pair<std::string, std::string>>{
           {"<light type='point'/>", "name"},
           {"<light name='a' type='laser'/>", "laser"},
           {"<light name='a'/>", "type"},
           {"<light name='a' type='directional'><direction>0 0 0</direction></light>", "direction"},
           {"<light name='a' type='directional'><direction>0 1</direction></light>", "direction"},
           {"<light name='a' type='point'><pose>0 0 nan 0 0 0</pose></light>", "pose"},
           {"<light name='a' type='point'><diffuse>1 -1 1 1</diffuse></light>", "diffuse"},
           {"<light name='a' type='point'><diffuse>red</diffuse></light>", "diffuse"},
           {"<light name='a' type='point'><attenuation><linear>-1</linear></attenuation></light>", "linear"},
           {"<light name='a' "
            "type='spot'><spot><inner_angle>1</inner_angle><outer_angle>0.5</outer_angle></spot></light>",
            "outer_angle"},
           {"<light name='a' type='spot'/>", "outer_angle"},
           {"<model name='a'/>", "<light>"},
           {"<light", "test"}}) {
    const std::string said = messageOf<ModelError>([&text = xml] { lightFromSdf(text, "test"); });
    EXPECT_HAS(said, named);
    EXPECT_EQ(said.find("test"), 0u) << said;
  }
}

TEST(LightEntry, GoesToYamlAndBack) {
  for (const char* xml : {kSun, kSpot}) {
    Light light = lightFromSdf(xml, "test");
    light.attached_to = "tool";
    light.diffuse *= 3.0;
    const Light back = lightFromYaml(lightYaml(light));
    EXPECT_EQ(back.name, light.name);
    EXPECT_EQ(back.type, light.type);
    EXPECT_EQ(back.attached_to, "tool");
    EXPECT_TRUE(back.diffuse.isApprox(light.diffuse, kRounding));
    EXPECT_TRUE(back.specular.isApprox(light.specular, kRounding));
    EXPECT_TRUE(back.direction_A.isApprox(light.direction_A, kRounding));
    EXPECT_EQ(back.casts_shadows, light.casts_shadows);
    if (light.type == Light::Type::kDirectional) continue;
    EXPECT_TRUE(back.position_A.isApprox(light.position_A, kRounding));
    EXPECT_EQ(back.range_m, light.range_m);
    EXPECT_EQ(back.linear_per_m, light.linear_per_m);
    EXPECT_EQ(back.outer_angle_rad, light.outer_angle_rad);
    EXPECT_EQ(back.falloff, light.falloff);
  }
}

TEST(LightEntry, IsReadFromEitherText) {
  EXPECT_EQ(lightFromText(" \n<light name='a' type='point'/>").name, "a");
  EXPECT_EQ(lightFromText("{name: b, type: point}").name, "b");
  EXPECT_THROW(lightFromText(" "), ParameterError);
  EXPECT_THROW(lightFromText("{name: b, type: point"), ParameterError);
  EXPECT_THROW(lightFromText("{name: b, type: directional}"), ParameterError);
  EXPECT_THROW(lightFromText("just words"), ParameterError);
}

}  // namespace
}  // namespace aras_visual_servo_sim::light_entry_test
