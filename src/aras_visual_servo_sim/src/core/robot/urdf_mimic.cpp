#include <algorithm>
#include <cmath>
#include <limits>

#include "urdf_extensions.hpp"

namespace aras_visual_servo_sim {

using tinyxml2::XMLElement;

namespace {

/** Index of a joint by name, -1 if there is none. */
int findJoint(const RobotModel& model, const std::string& name) {
  for (std::size_t i = 0; i < model.joints.size(); ++i) {
    if (model.joints[i].name == name) return static_cast<int>(i);
  }
  return -1;
}

double numberOr(const UrdfSource& source, const XMLElement& element, const char* attribute, double fallback,
                const std::string& owner) {
  return element.Attribute(attribute) ? numbersOf(source, element, attribute, 1, owner)[0] : fallback;
}

/** Follows each chain of mimics to its end, so that every follower names a joint that follows nobody. */
void resolveChains(const UrdfSource& source, const XMLElement& robot, RobotModel& model) {
  for (Joint& joint : model.joints) {
    for (std::size_t steps = 0; joint.mimic.joint >= 0; ++steps) {
      const Mimic& next = model.joints[joint.mimic.joint].mimic;
      if (next.joint < 0) break;
      if (steps == model.joints.size()) {
        source.fail(robot, "joint '" + joint.name + "': found a loop of <mimic>, must end at a joint without one");
      }
      joint.mimic.offset += joint.mimic.multiplier * next.offset;
      joint.mimic.multiplier *= next.multiplier;
      joint.mimic.joint = next.joint;
    }
  }
}

/** Limits of the follower, seen as limits of the joint it follows. */
void narrowLimits(const UrdfSource& source, const XMLElement& robot, const Joint& follower, Joint& followed) {
  const double k = follower.mimic.multiplier;
  if (k == 0.0) return;
  const double one = (follower.limits.lower - follower.mimic.offset) / k;
  const double other = (follower.limits.upper - follower.mimic.offset) / k;
  JointLimits& limits = followed.limits;
  if (follower.limits.has_position) {
    limits.lower = limits.has_position ? std::max(limits.lower, std::min(one, other)) : std::min(one, other);
    limits.upper = limits.has_position ? std::min(limits.upper, std::max(one, other)) : std::max(one, other);
    limits.has_position = true;
  }
  if (limits.has_position && limits.lower > limits.upper) {
    source.fail(robot, "joint '" + follower.name + "' mimics '" + followed.name +
                           "': found position limits of the two that exclude each other, must leave a common interval");
  }
  if (follower.limits.has_velocity) {
    const double velocity = follower.limits.velocity / std::abs(k);
    limits.velocity = limits.has_velocity ? std::min(limits.velocity, velocity) : velocity;
    limits.has_velocity = true;
  }
}

}  // namespace

void readMimics(const UrdfSource& source, const XMLElement& robot, RobotModel& model) {
  for (const XMLElement* element = robot.FirstChildElement("joint"); element;
       element = element->NextSiblingElement("joint")) {
    const XMLElement* mimic = element->FirstChildElement("mimic");
    if (!mimic) continue;
    Joint& joint = model.joints[findJoint(model, element->Attribute("name"))];
    const std::string owner = "joint '" + joint.name + "'";
    const std::string followed = mimic->Attribute("joint");
    if (!joint.moves()) {
      source.warn(*mimic, owner + ": does not move, <mimic> is ignored");
      continue;
    }
    const int index = findJoint(model, followed);
    if (index < 0 || !model.joints[index].moves()) {
      source.fail(*mimic, owner + ": mimics joint '" + followed + "', must be a moving <joint> of this file");
    }
    joint.mimic.joint = index;
    joint.mimic.multiplier = numberOr(source, *mimic, "multiplier", 1.0, owner);
    joint.mimic.offset = numberOr(source, *mimic, "offset", 0.0, owner);
  }
  resolveChains(source, robot, model);
  for (const Joint& joint : model.joints) {
    if (joint.mimic.joint >= 0) narrowLimits(source, robot, joint, model.joints[joint.mimic.joint]);
  }
}

}  // namespace aras_visual_servo_sim
