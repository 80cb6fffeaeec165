#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "aras_visual_servo_sim/config/section.hpp"
#include "aras_visual_servo_sim/config/types.hpp"
#include "aras_visual_servo_sim/physics/contact_config.hpp"
#include "aras_visual_servo_sim/physics/joint_controller.hpp"

namespace aras_visual_servo_sim {

/** Whether the robot's root link is held or moves freely. */
enum class Base {
  kFromModel,  ///< floating if the URDF's first joint is, else fixed
  kFixed,
  kFloating
};

struct WorldConfig {
  double period_s = defaultOf<double>("sim", "period_s");
  Eigen::Vector3d gravity_m_s2 = defaultOf<Eigen::Vector3d>("sim", "gravity_m_s2");
  Drive drive = Drive::kImplicit;
  double command_timeout_s = 0.0;             ///< a velocity command older than this (simulated) counts as 0; 0: never
  std::vector<ControllerConfig> controllers;  ///< joints without one are passive
  ContactConfig contacts;                     ///< none by default
  Base base = Base::kFromModel;
  /** Initial pose of the root link, or of the child of a floating joint; default: the world frame, or that joint's
   *  origin. */
  std::optional<Pose> X_WB;
};

}  // namespace aras_visual_servo_sim
