#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <sstream>
#include <string>

#include "aras_visual_servo_sim/physics/multibody_world.hpp"
#include "aras_visual_servo_sim/robot/urdf_loader.hpp"
#include "tools/messages.hpp"

namespace aras_visual_servo_sim {

constexpr double kPi = 3.14159265358979323846;
constexpr double kGravity = 9.81;

inline std::string readUrdf(const std::string& name) {
  std::ifstream file(std::string(ARAS_SIM_TEST_DIR) + "/urdf/" + name);
  EXPECT_TRUE(file.good()) << name;
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

/** Text with its one occurrence of `from` replaced; fails the test when there is none. */
inline std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  EXPECT_NE(at, std::string::npos) << "'" << from << "' is not in the file";
  return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

inline RobotModel modelOf(const std::string& urdf) { return loadRobotModel(urdf, "test.urdf"); }

/** slider.urdf with other numbers. */
inline RobotModel sliderModel(double friction = 0.0, double damping = 0.0, double upper = 100.0, double effort = 1000.0,
                              double velocity = 1000.0) {
  const auto text = [](double value) {
    std::ostringstream out;
    out.precision(17);
    out << '"' << value << '"';
    return out.str();
  };
  std::string urdf = readUrdf("slider.urdf");
  urdf = replaced(urdf, "friction=\"0\"", "friction=" + text(friction));
  urdf = replaced(urdf, "damping=\"0\"", "damping=" + text(damping));
  urdf = replaced(urdf, "upper=\"100\"", "upper=" + text(upper));
  urdf = replaced(urdf, "effort=\"1000\"", "effort=" + text(effort));
  urdf = replaced(urdf, "velocity=\"1000\"", "velocity=" + text(velocity));
  return modelOf(urdf);
}

inline Eigen::VectorXd vectorOf(std::initializer_list<double> values) {
  Eigen::VectorXd v(values.size());
  int i = 0;
  for (double value : values) v[i++] = value;
  return v;
}

inline ControllerConfig controllerOf(const std::string& joint, ControllerType type, const PidGains& gains = {}) {
  ControllerConfig config;
  config.name = joint + "_controller";
  config.joint = joint;
  config.type = type;
  config.gains = gains;
  return config;
}

inline WorldConfig weightless(double period_s = 0.001) {
  WorldConfig config;
  config.period_s = period_s;
  config.gravity_m_s2.setZero();
  return config;
}

/** The published gains, for six_joint_arm.urdf. */
inline WorldConfig publishedDrives(Drive drive = Drive::kImplicit) {
  WorldConfig config;
  config.drive = drive;
  const auto add = [&](const char* joint, double p, double i, double d) {
    config.controllers.push_back(
        controllerOf(joint, ControllerType::kEffortPosition, PidGains{p, i, d, -1000.0, 1000.0, false}));
  };
  add("gantry", 15000, 5, 400);
  add("J1", 3000, 40, 40);
  add("J2", 7000, 1000, 165);
  add("J3", 4000, 200, 0);
  add("J5", 3500, 150, 0);
  add("J6", 70, 2, 0);
  return config;
}

}  // namespace aras_visual_servo_sim
