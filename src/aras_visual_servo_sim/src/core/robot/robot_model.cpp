#include "aras_visual_servo_sim/robot/robot_model.hpp"

#include <algorithm>
#include <aras_visual_servo_common/text.hpp>
#include <cmath>

#include "aras_visual_servo_sim/config/errors.hpp"

namespace aras_visual_servo_sim {

std::string scoped(const std::string& robot, const std::string& name) {
  return robot.empty() ? name : robot + "::" + name;
}

double Joint::dryFriction(double v) const {
  double effort = friction;
  for (const Stribeck& each : stribeck) effort += each.excess * std::exp(-std::pow(v / each.velocity, 2));
  return effort;
}

int RobotModel::jointIndex(const std::string& joint_name) const {
  const auto found = std::lower_bound(joint_names.begin(), joint_names.end(), joint_name);
  if (found != joint_names.end() && *found == joint_name) return static_cast<int>(found - joint_names.begin());
  throw UnknownNameError("joint '" + joint_name + "' does not exist or does not move, allowed: " +
                         aras_visual_servo_common::joined(joint_names));
}

const Joint* RobotModel::floatingJoint() const {
  for (const Joint& joint : joints) {
    if (joint.type == JointType::kFloating) return &joint;
  }
  return nullptr;
}

int RobotModel::linkIndex(const std::string& link_name) const {
  std::string known;
  for (std::size_t i = 0; i < links.size(); ++i) {
    if (links[i].name == link_name) return static_cast<int>(i);
    known += (known.empty() ? "" : ", ") + links[i].name;
  }
  throw UnknownNameError("link '" + link_name + "' does not exist, allowed: " + known);
}

}  // namespace aras_visual_servo_sim
