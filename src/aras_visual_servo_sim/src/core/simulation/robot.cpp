#include "aras_visual_servo_sim/simulation/robot.hpp"

#include <algorithm>
#include <utility>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "aras_visual_servo_sim/config/section.hpp"

namespace aras_visual_servo_sim {

Robot::Robot(const std::string& name, int number, RobotModel model, const SimulationConfig& config,
             std::int64_t period_ns, const PackagePaths& packages)
    : name_(name),
      number_(number),
      model_(std::move(model)),
      config_(config.world),
      period_ns_(period_ns),
      start_{config.initial_positions, {}, {}},
      contacts_(config_.contacts, model_, packages),
      commands_(config_.command_timeout_s, config.command_delay_s, period_ns) {}

std::vector<std::string> Robot::scopedLinks() const {
  std::vector<std::string> names;
  for (const Link& link : model_.links) names.push_back(scoped(name_, link.name));
  return names;
}

void Robot::checkStart() const {
  FaultList faults;
  const std::vector<std::string>& names = jointNames(model_, config_);
  for (const auto& joint : start_.positions) {
    if (std::binary_search(names.begin(), names.end(), joint.first)) continue;
    faults.add("joint '" + joint.first + "' does not exist or does not move, allowed: " + joined(names));
  }
  faults.throwIfAny();
}

void Robot::makeBody() {
  WorldConfig config = config_;
  config.contacts = contacts_.present();
  body_ = std::make_unique<MultibodyWorld>(model_, config);
  Eigen::VectorXd q = body_->jointPositions();
  const std::vector<std::string>& names = body_->jointNames();
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto named = start_.positions.find(names[i]);
    if (named != start_.positions.end()) q[static_cast<Eigen::Index>(i)] = named->second;
  }
  body_->reset(q);
  body_->setJointPositions(start_.positions);  // refuses a mimic joint away from its leader
  start_.q = body_->jointPositions();
  start_.X_WB = body_->basePose();
}

void Robot::putBack() {
  std::map<std::string, double> positions;
  for (std::size_t i = 0; i < body_->jointNames().size(); ++i) {
    positions[body_->jointNames()[i]] = start_.q[static_cast<Eigen::Index>(i)];
  }
  body_->setJointPositions(positions);
  if (body_->floatingBase()) body_->setBasePose(start_.X_WB);
}

void Robot::setTwist(const Twist& V_WL_L, const std::string& link, std::optional<std::int64_t> stamp_ns) {
  JointCommand command;
  try {
    command = body_->twistCommand(V_WL_L, link);
  } catch (const ArasError& error) {
    refuse(error.what());
    throw;
  }
  setCommand(command, stamp_ns);
}

void Robot::setJointPositions(const std::map<std::string, double>& positions) {
  body_->setJointPositions(positions);
  commands_.drop();
  placed_();
}

void Robot::setBase(const Pose& X_WB, const Twist& V_WB_W) {
  if (!V_WB_W.allFinite()) throw NotFiniteError("setBase: found a twist that is not finite, must be finite");
  body_->setBasePose(X_WB);
  if (!body_->drivenBase()) body_->setBaseTwist(V_WB_W);
  placed_();
}

const Robot& robotOf(const Robots& robots, int number) {
  std::size_t k = 0;
  while (robots[k]->number() != number) ++k;
  return *robots[k];
}

std::pair<const Robot*, int> findLink(const Robots& robots, const std::string& link) {
  for (const auto& robot : robots) {
    const std::string prefix = scoped(robot->name(), "");
    if (link.compare(0, prefix.size(), prefix) != 0) continue;
    const std::vector<Link>& links = robot->model().links;
    for (std::size_t k = 0; k < links.size(); ++k) {
      if (link.compare(prefix.size(), std::string::npos, links[k].name) == 0) return {robot.get(), static_cast<int>(k)};
    }
  }
  std::vector<std::string> known;
  for (const auto& robot : robots) {
    for (const std::string& name : robot->scopedLinks()) known.push_back(name);
  }
  throw UnknownNameError("link '" + link + "' does not exist, allowed: " + joined(known));
}

}  // namespace aras_visual_servo_sim
