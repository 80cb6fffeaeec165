#include "urdf_extensions.hpp"

#include <algorithm>
#include <cmath>

#include "robot/gazebo/gazebo_tags.hpp"
#include "urdf_check.hpp"

namespace aras_visual_servo_sim {

using tinyxml2::XMLElement;

namespace {

bool hasLink(const RobotModel& model, const std::string& name) {
  for (const auto& link : model.links) {
    if (link.name == name) return true;
  }
  return false;
}

/** Gives every visual of a link one of Gazebo's materials. @return false if there is none of that name */
bool paintLink(const std::string& material, const std::string& link, RobotModel& model) {
  const std::optional<GazeboMaterial> found = gazeboMaterial(material);
  if (!found || !hasLink(model, link)) return false;
  for (Visual& visual : model.links[model.linkIndex(link)].visuals) paint(*found, visual);
  return true;
}

std::string printed(const XMLElement& element) {
  tinyxml2::XMLPrinter printer;
  element.Accept(&printer);
  return printer.CStr();
}

}  // namespace

void readTransmissions(const UrdfSource& source, const XMLElement& robot, RobotModel& model) {
  for (const XMLElement* transmission = robot.FirstChildElement("transmission"); transmission;
       transmission = transmission->NextSiblingElement("transmission")) {
    const XMLElement* actuator = transmission->FirstChildElement("actuator");
    for (const XMLElement* end = transmission->FirstChildElement("joint"); end;
         end = end->NextSiblingElement("joint")) {
      const std::string name = end->Attribute("name") ? end->Attribute("name") : "";
      Joint* joint = nullptr;
      for (auto& each : model.joints) {
        if (each.name == name) joint = &each;
      }
      if (!joint) source.fail(*end, "transmission acts on joint '" + name + "', must be a <joint> of this file");
      // Older files have it in the actuator.
      const XMLElement* holder = end->FirstChildElement("hardwareInterface") ? end : actuator;
      for (const XMLElement* interface = holder ? holder->FirstChildElement("hardwareInterface") : nullptr; interface;
           interface = interface->NextSiblingElement("hardwareInterface")) {
        const std::string text = textOf(interface);
        const auto slash = text.rfind('/');
        joint->hardware_interfaces.push_back(slash == std::string::npos ? text : text.substr(slash + 1));
      }
    }
    const std::string reduction = childText(actuator, "mechanicalReduction");
    if (!reduction.empty() && std::strtod(reduction.c_str(), nullptr) != 1.0) {
      source.warn(*transmission, "mechanicalReduction '" + reduction + "' is ignored");
    }
  }
}

void readGazeboTags(const UrdfSource& source, const XMLElement& robot, RobotModel& model) {
  for (const XMLElement* gazebo = robot.FirstChildElement("gazebo"); gazebo;
       gazebo = gazebo->NextSiblingElement("gazebo")) {
    const std::string reference = gazebo->Attribute("reference") ? gazebo->Attribute("reference") : "";
    for (const XMLElement* child = gazebo->FirstChildElement(); child; child = child->NextSiblingElement()) {
      const std::string tag = child->Name();
      const char* type = child->Attribute("type");
      const std::string sensor = tag == "sensor" && type ? type : "";
      if (sensor == "camera" || (sensor == "wideanglecamera" && hasEquidistantLens(source, *child))) {
        if (!hasLink(model, reference)) {
          source.fail(*gazebo, "reference is '" + reference + "', must be a <link> of this file");
        }
        model.cameras.push_back(readCameraSensor(source, *child, reference));
        continue;
      }
      if (sensor == "wideanglecamera") continue;  // warned of
      if (tag == "light") {
        if (!hasLink(model, reference)) {
          source.fail(*gazebo, "reference is '" + reference + "', must be a <link> of this file");
        }
        model.lights.push_back({reference, printed(*child)});
        continue;
      }
      if (tag == "visual" && hasLink(model, reference)) {
        readVisualTag(source, *child, robot, model.links[model.linkIndex(reference)]);
        continue;
      }
      const std::string material = tag == "material" ? textOf(child) : "";
      if (!material.empty() && paintLink(material, reference, model)) continue;
      const std::string why = material.empty() ? "" : "material '" + material + "' is not a plain colour of Gazebo's: ";
      source.warn(*child, "in <gazebo reference='" + reference + "'>: " + why + "ignored");
    }
  }
}

namespace {

/** Index of a joint by name, -1 if there is none. */
int findJoint(const RobotModel& model, const std::string& name) {
  for (std::size_t i = 0; i < model.joints.size(); ++i) {
    if (model.joints[i].name == name) return static_cast<int>(i);
  }
  return -1;
}

/** Follows each chain of mimics to its end, so that every follower names a joint that follows none. */
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
    joint.mimic.multiplier = numberOf(source, *mimic, "multiplier", 1.0, owner);
    joint.mimic.offset = numberOf(source, *mimic, "offset", 0.0, owner);
  }
  resolveChains(source, robot, model);
  for (const Joint& joint : model.joints) {
    if (joint.mimic.joint >= 0) narrowLimits(source, robot, joint, model.joints[joint.mimic.joint]);
  }
}

void readStribeck(const UrdfSource& source, const XMLElement& robot, RobotModel& model) {
  for (const XMLElement* element = robot.FirstChildElement("joint"); element;
       element = element->NextSiblingElement("joint")) {
    const XMLElement* dynamics = element->FirstChildElement("dynamics");
    if (!dynamics || !dynamics->Attribute("static_friction")) continue;
    Joint& joint = model.joints[findJoint(model, element->Attribute("name"))];
    const std::string owner = "joint '" + joint.name + "'";
    const double excess = numberOf(source, *dynamics, "static_friction", 0.0, owner) - joint.friction;
    if (excess > 0.0) joint.stribeck = {{excess, numberOf(source, *dynamics, "stribeck_velocity", 0.0, owner)}};
  }
}

}  // namespace aras_visual_servo_sim
