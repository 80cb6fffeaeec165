#pragma once

#include <optional>
#include <string>
#include <vector>

#include "aras_visual_servo_sim/physics/managed/controller.hpp"
#include "aras_visual_servo_sim/physics/pid.hpp"

namespace aras_visual_servo_sim {

/** A PID on the position of a joint whose output is the joint's velocity: velocity_controllers/JointPositionController.
 *  The error is the shortest way round for a joint that turns, within its limits if it has any. */
class VelocityPositionController : public Controller {
 public:
  /** @param drive  of type kVelocity, with the gains @param joint  that it moves */
  VelocityPositionController(std::string name, std::string type, ControllerConfig drive, const Joint& joint);

  bool takeCommand(double position) override;
  bool takeGains(const PidGains& gains) override;
  std::optional<ControllerState> pidState() const override;

  void start(double time_s, const std::vector<JointNow>& joints) override;
  bool acts() const override { return true; }
  void update(double time_s, double dt_s, const std::vector<JointNow>& joints,
              std::vector<JointTarget>& targets) override;
  void visit(Archive& archive) override;

 private:
  double error(double position) const;

  JointType joint_type_;
  JointLimits limits_;
  Pid pid_;
  double set_point_ = 0.0, dt_s_ = 0.0;
  JointNow last_;
};

}  // namespace aras_visual_servo_sim
