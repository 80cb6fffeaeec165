#include "aras_visual_servo_sim/simulation/start.hpp"

#include <algorithm>
#include <vector>

#include "aras_visual_servo_sim/config/section.hpp"

namespace aras_visual_servo_sim {

void Start::check(const RobotModel& model, const WorldConfig& config) const {
  FaultList faults;
  const std::vector<std::string>& names = jointNames(model, config);
  for (const auto& joint : positions_) {
    if (std::binary_search(names.begin(), names.end(), joint.first)) continue;
    std::string known;
    for (const auto& each : names) known += (known.empty() ? "" : ", ") + each;
    faults.add("joint '" + joint.first + "' does not exist or does not move, allowed: " + known);
  }
  faults.throwIfAny();
}

std::unique_ptr<MultibodyWorld> Start::makeWorld(const RobotModel& model, const WorldConfig& config) {
  auto world = std::make_unique<MultibodyWorld>(model, config);
  Eigen::VectorXd q = world->jointPositions();
  const std::vector<std::string>& names = world->jointNames();
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto named = positions_.find(names[i]);
    if (named != positions_.end()) q[static_cast<Eigen::Index>(i)] = named->second;
  }
  world->reset(q);
  world->setJointPositions(positions_);  // refuses a mimic joint away from its leader
  q_ = world->jointPositions();
  X_WB_ = world->basePose();
  return world;
}

void Start::putBack(MultibodyWorld& world) const {
  std::map<std::string, double> positions;
  for (std::size_t i = 0; i < world.jointNames().size(); ++i) {
    positions[world.jointNames()[i]] = q_[static_cast<Eigen::Index>(i)];
  }
  world.setJointPositions(positions);
  if (world.floatingBase()) world.setBasePose(X_WB_);
}

}  // namespace aras_visual_servo_sim
