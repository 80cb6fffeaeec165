#include "urdf_check.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <set>
#include <sstream>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "aras_visual_servo_sim/config/section.hpp"

namespace aras_visual_servo_sim {

using tinyxml2::XMLElement;

std::string UrdfSource::at(const XMLElement& element, const std::string& text) const {
  return name + ":" + std::to_string(element.GetLineNum()) + ": <" + element.Name() + ">: " + text;
}

void UrdfSource::fail(const XMLElement& element, const std::string& text) const { throw ModelError(at(element, text)); }

void UrdfSource::warn(const XMLElement& element, const std::string& text) const {
  warnings->push_back(at(element, text));
}

std::vector<double> numbersOf(const UrdfSource& source, const XMLElement& element, const char* attribute,
                              std::size_t count, const std::string& owner) {
  const char* text = element.Attribute(attribute);
  const std::string what = owner + ": " + attribute;
  const std::string allowed = count == 1 ? "a finite number" : std::to_string(count) + " finite numbers";
  if (!text) source.fail(element, what + " is missing, must be " + allowed);
  std::vector<double> values;
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    char* end = nullptr;
    const double value = std::strtod(word.c_str(), &end);
    if (*end != '\0' || !std::isfinite(value)) {
      source.fail(element, what + " is '" + text + "', must be " + allowed);
    }
    values.push_back(value);
  }
  if (values.size() != count) source.fail(element, what + " is '" + text + "', must be " + allowed);
  return values;
}

double numberOf(const UrdfSource& source, const XMLElement& element, const char* attribute, double fallback,
                const std::string& owner) {
  return element.Attribute(attribute) ? numbersOf(source, element, attribute, 1, owner)[0] : fallback;
}

void warnOfOthers(const UrdfSource& source, const XMLElement* parent, std::initializer_list<const char*> known) {
  for (const XMLElement* child = parent ? parent->FirstChildElement() : nullptr; child;
       child = child->NextSiblingElement()) {
    const std::string name = child->Name();
    if (std::none_of(known.begin(), known.end(), [&](const char* each) { return name == each; })) {
      source.warn(*child, "in <" + std::string(parent->Name()) + ">: ignored");
    }
  }
}

namespace {

/** Humanoids with hands have about a hundred. Chains are walked by functions that call themselves. */
constexpr std::size_t kMostLinks = 1000;

std::string quoted(const std::string& text) { return "'" + text + "'"; }

std::string nameOf(const UrdfSource& source, const XMLElement& element, std::set<std::string>& taken) {
  const char* name = element.Attribute("name");
  if (!name || !*name) source.fail(element, "name is missing, must be a non-empty text");
  if (!taken.insert(name).second) {
    source.fail(element, std::string(element.Name()) + " " + quoted(name) + ": name is used twice, must be unique");
  }
  return name;
}

/** Moments of inertia, damping and friction, factors of mimics: more than any robot has, and products of them are
 *  finite. Lengths, angles, masses and scales have the bounds of the section solid. */
constexpr double kMostInertia = 1e12, kMostDamping = 1e9, kMostMimic = 1e6;

void requireWithin(const UrdfSource& source, const XMLElement& element, const std::string& what, double value,
                   double most) {
  if (std::abs(value) <= most) return;
  source.fail(element,
              what + " is " + numberText(value) + ", must be from " + numberText(-most) + " to " + numberText(most));
}

/** The largest number that the section solid allows for a key, or for each element of it. */
double mostOf(const char* key) {
  const auto& described = sectionOf("solid").properties.at(key);
  return (described->items ? described->items : described)->range.max;
}

void checkOrigin(const UrdfSource& source, const XMLElement& parent, const std::string& owner) {
  const XMLElement* origin = parent.FirstChildElement("origin");
  if (!origin) return;
  for (const auto& [attribute, key] : {std::pair{"xyz", "position_m"}, std::pair{"rpy", "rpy_rad"}}) {
    if (!origin->Attribute(attribute)) continue;
    for (const double value : numbersOf(source, *origin, attribute, 3, owner)) {
      requireWithin(source, *origin, owner + ": " + attribute, value, mostOf(key));
    }
  }
}

void checkInertial(const UrdfSource& source, const XMLElement& inertial, const std::string& owner) {
  checkOrigin(source, inertial, owner);
  const XMLElement* mass = inertial.FirstChildElement("mass");
  if (!mass) source.fail(inertial, owner + ": <mass> is missing, must be there");
  const double mass_kg = numbersOf(source, *mass, "value", 1, owner)[0];
  if (mass_kg < 0.0) source.fail(*mass, owner + ": mass is " + numberText(mass_kg) + ", must be >= 0");
  requireWithin(source, *mass, owner + ": mass", mass_kg, mostOf("mass_kg"));
  const XMLElement* inertia = inertial.FirstChildElement("inertia");
  if (!inertia) source.fail(inertial, owner + ": <inertia> is missing, must be there");
  const auto entry = [&](const char* key) {
    const double value = numbersOf(source, *inertia, key, 1, owner)[0];
    requireWithin(source, *inertia, owner + ": " + key, value, kMostInertia);
    return value;
  };
  Eigen::Matrix3d tensor;
  tensor(0, 0) = entry("ixx");
  tensor(1, 1) = entry("iyy");
  tensor(2, 2) = entry("izz");
  tensor(0, 1) = tensor(1, 0) = entry("ixy");
  tensor(0, 2) = tensor(2, 0) = entry("ixz");
  tensor(1, 2) = tensor(2, 1) = entry("iyz");
  const Eigen::Vector3d principal = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(tensor).eigenvalues();
  // Many files have links without mass for cameras and tools; such a link needs no inertia.
  if (mass_kg == 0.0 && !tensor.isZero(0.0)) source.warn(inertial, owner + ": mass is 0, its inertia is ignored");
  // A solid disc meets the triangle inequality with equality, a rod has a moment of zero: allow for the digits a file
  // is written with.
  constexpr double kWrittenDigits = 1e-3;
  if (!(principal.minCoeff() >= -kWrittenDigits * principal.cwiseAbs().maxCoeff())) {
    source.fail(*inertia, owner + ": inertia has the principal moment " + numberText(principal.minCoeff()) +
                              ", all must be >= 0 (positive semidefinite)");
  }
  if (principal(2) > (principal(0) + principal(1)) * (1.0 + kWrittenDigits)) {
    source.warn(*inertia, owner + ": principal moments break the triangle inequality, no rigid body has them");
  }
}

void checkGeometry(const UrdfSource& source, const XMLElement& visual, const std::string& owner) {
  const XMLElement* geometry = visual.FirstChildElement("geometry");
  const XMLElement* shape = geometry ? geometry->FirstChildElement() : nullptr;
  if (!shape) source.fail(visual, owner + ": <geometry> with a shape is missing, must be there");
  const std::string type = shape->Name();
  const auto positive = [&](const char* attribute, std::size_t count) {
    for (double value : numbersOf(source, *shape, attribute, count, owner)) {
      if (value <= 0.0) source.fail(*shape, owner + ": " + attribute + " is " + numberText(value) + ", must be > 0");
      requireWithin(source, *shape, owner + ": " + attribute, value, mostOf("box_m"));
    }
  };
  if (type == "box") {
    positive("size", 3);
  } else if (type == "cylinder") {
    positive("radius", 1);
    positive("length", 1);
  } else if (type == "sphere") {
    positive("radius", 1);
  } else if (type == "mesh") {
    if (!shape->Attribute("filename")) source.fail(*shape, owner + ": filename is missing, must be there");
    if (shape->Attribute("scale")) {
      for (const double value : numbersOf(source, *shape, "scale", 3, owner)) {
        requireWithin(source, *shape, owner + ": scale", value, mostOf("scale"));
      }
    }
  } else {
    source.fail(*shape, owner + ": shape is " + quoted(type) + ", must be box, cylinder, sphere or mesh");
  }
}

void checkLink(const UrdfSource& source, const XMLElement& link, const std::string& owner, bool& has_collision) {
  for (const XMLElement* child = link.FirstChildElement(); child; child = child->NextSiblingElement()) {
    const std::string tag = child->Name();
    if (tag == "inertial") {
      checkInertial(source, *child, owner);
    } else if (tag == "visual") {
      checkOrigin(source, *child, owner);
      checkGeometry(source, *child, owner);
    } else if (tag == "collision") {
      has_collision = true;
    } else {
      source.warn(*child, owner + ": ignored");
    }
  }
}

void checkLimit(const UrdfSource& source, const XMLElement& joint, const std::string& type, const std::string& owner) {
  const XMLElement* limit = joint.FirstChildElement("limit");
  const bool bounded = type == "revolute" || type == "prismatic";
  if (!limit) {
    if (bounded) source.fail(joint, owner + ": <limit> is missing, must be there for " + quoted(type));
    return;
  }
  const double effort = numbersOf(source, *limit, "effort", 1, owner)[0];
  const double velocity = numbersOf(source, *limit, "velocity", 1, owner)[0];
  if (effort < 0.0) source.fail(*limit, owner + ": effort limit is " + numberText(effort) + ", must be >= 0");
  if (velocity <= 0.0) source.fail(*limit, owner + ": velocity limit is " + numberText(velocity) + ", must be > 0");
  const double lower = numberOf(source, *limit, "lower", 0.0, owner);
  const double upper = numberOf(source, *limit, "upper", 0.0, owner);
  if (bounded && lower > upper) {
    source.fail(*limit,
                owner + ": lower limit is " + numberText(lower) + ", must be <= the upper one, " + numberText(upper));
  }
}

void checkDynamics(const UrdfSource& source, const XMLElement& joint, const std::string& owner) {
  const XMLElement* dynamics = joint.FirstChildElement("dynamics");
  if (!dynamics) return;
  for (const char* attribute : {"damping", "friction", "static_friction", "stribeck_velocity"}) {
    const double value = numberOf(source, *dynamics, attribute, 0.0, owner);
    if (value < 0.0) source.fail(*dynamics, owner + ": " + attribute + " is " + numberText(value) + ", must be >= 0");
    requireWithin(source, *dynamics, owner + ": " + attribute, value, kMostDamping);
  }
  const bool given = dynamics->Attribute("static_friction") != nullptr;
  if (given != (dynamics->Attribute("stribeck_velocity") != nullptr)) {
    source.fail(*dynamics, owner + ": " + (given ? "stribeck_velocity" : "static_friction") +
                               " is missing, must stand " + "beside " +
                               (given ? "static_friction" : "stribeck_velocity"));
  }
  if (!given) return;
  const double friction = numberOf(source, *dynamics, "friction", 0.0, owner);
  const double at_rest = numberOf(source, *dynamics, "static_friction", 0.0, owner);
  const double velocity = numberOf(source, *dynamics, "stribeck_velocity", 0.0, owner);
  if (at_rest < friction) {
    source.fail(*dynamics, owner + ": static_friction is " + numberText(at_rest) + ", must be >= the friction, " +
                               numberText(friction));
  }
  if (velocity <= 0.0) source.fail(*dynamics, owner + ": stribeck_velocity is 0, must be > 0");
}

void checkSafety(const UrdfSource& source, const XMLElement& joint, const std::string& type, const std::string& owner) {
  const XMLElement* safety = joint.FirstChildElement("safety_controller");
  if (!safety) return;
  const double k_velocity = numbersOf(source, *safety, "k_velocity", 1, owner)[0];
  const double k_position = numberOf(source, *safety, "k_position", 0.0, owner);
  const double lower = numberOf(source, *safety, "soft_lower_limit", 0.0, owner);
  const double upper = numberOf(source, *safety, "soft_upper_limit", 0.0, owner);
  if (k_velocity < 0.0) source.fail(*safety, owner + ": k_velocity is " + numberText(k_velocity) + ", must be >= 0");
  if (k_position < 0.0) source.fail(*safety, owner + ": k_position is " + numberText(k_position) + ", must be >= 0");
  if (lower > upper) {
    source.fail(*safety, owner + ": soft_lower_limit is " + numberText(lower) + ", must be <= the upper one, " +
                             numberText(upper));
  }
  if (type != "continuous" && k_position == 0.0) {
    source.warn(*safety, owner + ": k_position is 0: as joint_limits_interface has it, its controller cannot move it");
  }
}

void checkMimic(const UrdfSource& source, const XMLElement& mimic, const std::string& owner) {
  if (!mimic.Attribute("joint")) source.fail(mimic, owner + ": joint is missing, must be the name of a joint");
  for (const char* attribute : {"multiplier", "offset"}) {
    requireWithin(source, mimic, owner + ": " + attribute, numberOf(source, mimic, attribute, 0.0, owner), kMostMimic);
  }
}

void checkJoint(const UrdfSource& source, const XMLElement& joint, const std::string& owner) {
  const char* text = joint.Attribute("type");
  const std::string type = text ? text : "";
  static const std::set<std::string> kTypes = {"revolute", "continuous", "prismatic", "fixed", "floating"};
  if (!kTypes.count(type)) {
    source.fail(joint, owner + ": type is " + quoted(type) + (type == "planar" ? ", which is not simulated" : "") +
                           ", must be revolute, continuous, prismatic, fixed or (the root's one joint) floating");
  }
  checkOrigin(source, joint, owner);
  for (const XMLElement* child = joint.FirstChildElement(); child; child = child->NextSiblingElement()) {
    const std::string tag = child->Name();
    if (tag == "mimic") checkMimic(source, *child, owner);
    static const std::set<std::string> kUsed = {"origin", "parent", "child",    "axis",
                                                "limit",  "mimic",  "dynamics", "safety_controller"};
    if (!kUsed.count(tag)) source.warn(*child, owner + ": ignored");
  }
  if (type == "fixed" || type == "floating") return;
  if (const XMLElement* axis = joint.FirstChildElement("axis")) {
    const auto xyz = numbersOf(source, *axis, "xyz", 3, owner);
    if (xyz[0] == 0.0 && xyz[1] == 0.0 && xyz[2] == 0.0) {
      source.fail(*axis, owner + ": axis is '" + axis->Attribute("xyz") + "', must not be zero");
    }
  }
  checkLimit(source, joint, type, owner);
  checkDynamics(source, joint, owner);
  checkSafety(source, joint, type, owner);
}

/** Link named by <parent> or <child>. */
std::string endOf(const UrdfSource& source, const XMLElement& joint, const char* tag, const std::string& owner,
                  const std::set<std::string>& links) {
  const XMLElement* end = joint.FirstChildElement(tag);
  const char* link = end ? end->Attribute("link") : nullptr;
  if (!link) source.fail(joint, owner + ": <" + tag + " link=...> is missing, must be there");
  if (!links.count(link)) {
    source.fail(*end, owner + ": " + tag + " link is " + quoted(link) + ", must be a <link> of this file");
  }
  return link;
}

/** A floating joint makes its child the free base: that needs a root that is nothing but the world. */
void checkFloating(const UrdfSource& source, const XMLElement& robot, const std::string& root) {
  int from_root = 0;
  const XMLElement* floating = nullptr;
  for (const XMLElement* joint = robot.FirstChildElement("joint"); joint; joint = joint->NextSiblingElement("joint")) {
    const bool at_root = root == joint->FirstChildElement("parent")->Attribute("link");
    from_root += at_root;
    if (std::string(joint->Attribute("type")) != "floating") continue;
    if (at_root) {
      floating = joint;
      continue;
    }
    source.fail(*joint, "joint " + quoted(joint->Attribute("name")) + ": type is 'floating' below the root link " +
                            quoted(root) + ", must be the root's one joint");
  }
  if (floating && from_root > 1) {
    source.fail(*floating, "joint " + quoted(floating->Attribute("name")) + ": type is 'floating', but the root link " +
                               quoted(root) + " carries " + std::to_string(from_root) +
                               " joints, must be the root's one joint");
  }
}

void checkTree(const UrdfSource& source, const XMLElement& robot, const std::set<std::string>& links,
               const std::map<std::string, std::string>& parent_of) {
  std::vector<std::string> roots;
  for (const auto& link : links) {
    if (!parent_of.count(link)) roots.push_back(link);
  }
  if (roots.empty()) source.fail(robot, "found no root link, the joints form a loop, must be a tree with one root");
  if (roots.size() > 1) {
    std::string names;
    for (const auto& root : roots) names += (names.empty() ? "" : ", ") + quoted(root);
    source.fail(robot, "found " + std::to_string(roots.size()) + " root links (" + names + "), must be one");
  }
  for (const auto& link : links) {
    std::string at = link;
    for (std::size_t i = 0; i <= links.size() && at != roots[0]; ++i) at = parent_of.at(at);
    if (at != roots[0]) source.fail(robot, "link " + quoted(link) + " is in a loop of joints, must hang from the root");
  }
  checkFloating(source, robot, roots[0]);
}

}  // namespace

void checkUrdf(const UrdfSource& source, const XMLElement& robot) {
  std::set<std::string> links, joints, transmissions;
  std::map<std::string, std::string> parent_of;
  bool has_collision = false;
  for (const XMLElement* link = robot.FirstChildElement("link"); link; link = link->NextSiblingElement("link")) {
    const std::string name = nameOf(source, *link, links);
    checkLink(source, *link, "link " + quoted(name), has_collision);
  }
  if (links.empty()) source.fail(robot, "found no <link>, must have at least one");
  if (links.size() > kMostLinks) {
    source.fail(robot, "found " + std::to_string(links.size()) + " links, allowed <= " + std::to_string(kMostLinks));
  }
  for (const XMLElement* joint = robot.FirstChildElement("joint"); joint; joint = joint->NextSiblingElement("joint")) {
    const std::string owner = "joint " + quoted(nameOf(source, *joint, joints));
    checkJoint(source, *joint, owner);
    const std::string parent = endOf(source, *joint, "parent", owner, links);
    const std::string child = endOf(source, *joint, "child", owner, links);
    if (!parent_of.emplace(child, parent).second) {
      source.fail(*joint, owner + ": child link " + quoted(child) + " has another parent already, must have one");
    }
  }
  checkTree(source, robot, links, parent_of);
  for (const XMLElement* child = robot.FirstChildElement(); child; child = child->NextSiblingElement()) {
    static const std::set<std::string> kUsed = {"link", "joint", "material", "transmission", "gazebo"};
    if (!kUsed.count(child->Name())) source.warn(*child, "ignored");
  }
  if (has_collision) source.warn(robot, "<collision> shapes count only for what sim/contacts names");
}

std::string textOf(const XMLElement* element) {
  const char* text = element ? element->GetText() : nullptr;
  if (!text) return "";
  const std::string all = text;
  const auto first = all.find_first_not_of(" \t\r\n");
  return first == std::string::npos ? "" : all.substr(first, all.find_last_not_of(" \t\r\n") - first + 1);
}

std::string childText(const XMLElement* parent, const char* tag) {
  return parent ? textOf(parent->FirstChildElement(tag)) : "";
}

double childNumber(const UrdfSource& source, const XMLElement* parent, const char* tag, double fallback) {
  const XMLElement* child = parent ? parent->FirstChildElement(tag) : nullptr;
  if (!child) return fallback;
  const std::string text = textOf(child);
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  if (text.empty() || *end != '\0' || !std::isfinite(value)) {
    source.fail(*child, "value is '" + text + "', must be a finite number");
  }
  return value;
}

bool childFlag(const UrdfSource& source, const XMLElement* parent, const char* tag, bool fallback) {
  const XMLElement* child = parent ? parent->FirstChildElement(tag) : nullptr;
  if (!child) return fallback;
  const std::string text = textOf(child);
  if (text == "true" || text == "True" || text == "1") return true;
  if (text == "false" || text == "False" || text == "0") return false;
  source.fail(*child, "value is '" + text + "', must be true or false");
}

}  // namespace aras_visual_servo_sim
