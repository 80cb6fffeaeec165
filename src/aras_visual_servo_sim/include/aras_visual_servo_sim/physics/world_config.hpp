#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "aras_visual_servo_sim/config/section.hpp"
#include "aras_visual_servo_sim/config/types.hpp"
#include "aras_visual_servo_sim/physics/contact_config.hpp"
#include "aras_visual_servo_sim/physics/joint_controller.hpp"
#include "aras_visual_servo_sim/robot/robot_model.hpp"

namespace aras_visual_servo_sim {

/** Whether the robot's root link is held or moves. */
enum class Base {
  kFromModel,  ///< floating if the URDF's first joint is, else fixed
  kFixed,
  kFloating,
  kDriven  ///< placed and moved by commands, without inertia; for robots without moving joints
};

struct WorldConfig {
  double period_s = SimConfig().period_s;
  Eigen::Vector3d gravity_m_s2 = SimConfig().gravity_m_s2;
  Drive drive = Drive::kImplicit;
  double command_timeout_s = 0.0;             ///< a velocity command older than this (simulated) counts as 0; 0: never
  std::vector<ControllerConfig> controllers;  ///< joints without one are passive
  bool hold_idle_joints = false;              ///< as Gazebo: a joint whose <transmission> has a position or velocity
                                              ///< interface stays where it is while no controller drives it
  ContactConfig contacts;                     ///< none by default
  Base base = Base::kFromModel;
  /** Initial pose of the root link, or of the child of a floating joint; default: the world frame, or that joint's
   *  origin. */
  std::optional<Pose> X_WB;
};

/** What joint vectors of this robot speak of, sorted: its moving joints, or the pose of a driven base as px, py, pz,
 * rx, ry, rz (position and rotation vector; as velocities the twist in the base's own axes, [v; w]). */
const std::vector<std::string>& jointNames(const RobotModel& model, const WorldConfig& config);

}  // namespace aras_visual_servo_sim
