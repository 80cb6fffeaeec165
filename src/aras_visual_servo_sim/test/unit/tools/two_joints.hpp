#pragma once

#include <string>

#include "tools/physics_tools.hpp"

namespace aras_visual_servo_sim {

/** Two joints `a` and `b` about parallel axes, with limits of 3 rad, 10 rad/s and 100 N m.
 *  @param interfaces  of both transmissions  @param type  of joint b */
inline RobotModel twoJoints(const std::string& interface = "EffortJointInterface",
                            const std::string& type = "revolute") {
  const std::string inertial =
      "<inertial><mass value='1'/><origin xyz='0.1 0 0'/>"
      "<inertia ixx='0.02' iyy='0.02' izz='0.02' ixy='0' ixz='0' iyz='0'/></inertial>";
  std::string urdf = "<robot name='two'>";
  for (const char* link : {"l0", "l1", "l2"}) urdf += "<link name='" + std::string(link) + "'>" + inertial + "</link>";
  for (int k = 0; k < 2; ++k) {
    const std::string name = k == 0 ? "a" : "b", parent = std::to_string(k), child = std::to_string(k + 1);
    urdf += "<joint name='" + name + "' type='" + (k == 0 ? "revolute" : type) + "'><parent link='l" + parent +
            "'/><child link='l" + child + "'/><origin xyz='0.2 0 0'/><axis xyz='0 0 1'/>" +
            "<limit lower='-3' upper='3' effort='100' velocity='10'/><dynamics damping='0.5'/></joint>" +
            "<transmission name='t" + name + "'><joint name='" + name + "'><hardwareInterface>" + interface +
            "</hardwareInterface></joint></transmission>";
  }
  return modelOf(urdf + "</robot>");
}

}  // namespace aras_visual_servo_sim
