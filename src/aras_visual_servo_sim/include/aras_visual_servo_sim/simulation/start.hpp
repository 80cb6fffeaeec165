#pragma once

#include <Eigen/Core>
#include <map>
#include <memory>
#include <string>

#include "aras_visual_servo_sim/physics/multibody_world.hpp"

namespace aras_visual_servo_sim {

/** Where the robot starts: its joints, and its base. */
class Start {
 public:
  /** @param positions  by joint name [m or rad]; a joint that is not named starts at 0, or where its limits exclude 0
   * at the nearer one */
  explicit Start(const std::map<std::string, double>& positions) : positions_(positions) {}

  /** @throws ParameterError naming each joint that the robot does not have */
  void check(const RobotModel& model, const WorldConfig& config) const;
  /** A world whose robot stands at the start. @throws as MultibodyWorld and its setJointPositions */
  std::unique_ptr<MultibodyWorld> makeWorld(const RobotModel& model, const WorldConfig& config);
  /** Puts the robot of the world made last back, at rest. */
  void putBack(MultibodyWorld& world) const;

 private:
  std::map<std::string, double> positions_;
  Eigen::VectorXd q_;
  Pose X_WB_;
};

}  // namespace aras_visual_servo_sim
