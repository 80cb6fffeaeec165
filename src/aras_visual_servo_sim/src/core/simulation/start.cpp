#include "aras_visual_servo_sim/simulation/start.hpp"

#include "aras_visual_servo_sim/config/section.hpp"

namespace aras_visual_servo_sim {

void Start::check(const RobotModel& model) const {
  FaultList faults;
  for (const auto& joint : positions_) faults.collect([&] { model.jointIndex(joint.first); });
  faults.throwIfAny();
}

std::unique_ptr<MultibodyWorld> Start::makeWorld(const RobotModel& model, const WorldConfig& config) {
  auto world = std::make_unique<MultibodyWorld>(model, config);
  Eigen::VectorXd q = Eigen::VectorXd::Zero(model.dofs());
  for (int i = 0; i < model.dofs(); ++i) {
    const auto named = positions_.find(model.joint_names[i]);
    q[i] = named != positions_.end() ? named->second : clampPosition(model.movingJoint(i).limits, 0.0);
  }
  world->reset(q);
  world->setJointPositions(positions_);  // refuses a mimic joint away from its leader
  q_ = world->jointPositions();
  X_WB_ = world->basePose();
  return world;
}

void Start::putBack(MultibodyWorld& world) const {
  std::map<std::string, double> positions;
  for (int i = 0; i < world.model().dofs(); ++i) positions[world.model().joint_names[i]] = q_[i];
  world.setJointPositions(positions);
  if (world.floatingBase()) world.setBasePose(X_WB_);
}

}  // namespace aras_visual_servo_sim
