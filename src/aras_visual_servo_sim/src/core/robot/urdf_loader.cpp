#include "aras_visual_servo_sim/robot/urdf_loader.hpp"

#include <console_bridge/console.h>
#include <urdf_parser/urdf_parser.h>

#include <algorithm>
#include <aras_visual_servo_common/files.hpp>
#include <mutex>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "urdf_check.hpp"
#include "urdf_extensions.hpp"

namespace aras_visual_servo_sim {

namespace {

constexpr std::size_t kMostUrdfBytes = 4 * 1024 * 1024;  // the largest of robots that are published have 0.3

/** Collects what urdfdom would print on stderr, for as long as it lives. One at a time: the handler is global. */
class MessageCapture : public console_bridge::OutputHandler {
 public:
  MessageCapture() : lock_(mutex()), level_(console_bridge::getLogLevel()) {
    console_bridge::setLogLevel(console_bridge::CONSOLE_BRIDGE_LOG_WARN);
    console_bridge::useOutputHandler(this);
  }
  ~MessageCapture() override {
    console_bridge::restorePreviousOutputHandler();
    console_bridge::setLogLevel(level_);
  }
  void log(const std::string& text, console_bridge::LogLevel, const char*, int) override { messages.push_back(text); }

  std::vector<std::string> messages;

 private:
  static std::mutex& mutex() {
    static std::mutex the_mutex;
    return the_mutex;
  }
  std::lock_guard<std::mutex> lock_;
  console_bridge::LogLevel level_;
};

Pose toPose(const urdf::Pose& pose) {
  const auto& q = pose.rotation;
  return Pose{{pose.position.x, pose.position.y, pose.position.z}, Eigen::Quaterniond(q.w, q.x, q.y, q.z).normalized()};
}

Geometry toGeometry(const urdf::Geometry& from) {
  Geometry to;
  if (from.type == urdf::Geometry::BOX) {
    const auto& dim = static_cast<const urdf::Box&>(from).dim;
    to.type = Geometry::Type::kBox;
    to.size_m = {dim.x, dim.y, dim.z};
  } else if (from.type == urdf::Geometry::CYLINDER) {
    const auto& cylinder = static_cast<const urdf::Cylinder&>(from);
    to.type = Geometry::Type::kCylinder;
    to.radius_m = cylinder.radius;
    to.length_m = cylinder.length;
  } else if (from.type == urdf::Geometry::SPHERE) {
    to.type = Geometry::Type::kSphere;
    to.radius_m = static_cast<const urdf::Sphere&>(from).radius;
  } else {
    const auto& mesh = static_cast<const urdf::Mesh&>(from);
    to.type = Geometry::Type::kMesh;
    to.filename = mesh.filename;
    to.scale = {mesh.scale.x, mesh.scale.y, mesh.scale.z};
  }
  return to;
}

Visual toVisual(const urdf::Visual& from, const std::string& link) {
  Visual to;
  to.link = link;
  to.X_link_visual = toPose(from.origin);
  to.geometry = toGeometry(*from.geometry);
  if (from.material) to.texture = from.material->texture_filename;
  if (from.material && to.texture.empty()) {
    const auto& color = from.material->color;
    to.color = {color.r, color.g, color.b, color.a};
    to.has_color = true;
  }
  return to;
}

Link toLink(const urdf::Link& from, int parent_joint) {
  Link to;
  to.name = from.name;
  to.parent_joint = parent_joint;
  if (from.inertial && from.inertial->mass > 0.0) {
    const auto& inertial = *from.inertial;
    const Pose X_link_com = toPose(inertial.origin);
    Eigen::Matrix3d tensor;
    tensor << inertial.ixx, inertial.ixy, inertial.ixz, inertial.ixy, inertial.iyy, inertial.iyz, inertial.ixz,
        inertial.iyz, inertial.izz;
    const Eigen::Matrix3d R = X_link_com.q.toRotationMatrix();
    to.mass_kg = inertial.mass;
    to.com_m = X_link_com.p;
    to.inertia_kg_m2 = R * tensor * R.transpose();
  }
  for (const auto& collision : from.collision_array) {
    if (collision->geometry) to.collisions.push_back({toGeometry(*collision->geometry), toPose(collision->origin)});
  }
  for (const auto& visual : from.visual_array) to.visuals.push_back(toVisual(*visual, from.name));
  return to;
}

Joint toJoint(const urdf::Joint& from, int parent_link, int child_link) {
  Joint to;
  to.name = from.name;
  to.type = from.type == urdf::Joint::REVOLUTE     ? JointType::kRevolute
            : from.type == urdf::Joint::CONTINUOUS ? JointType::kContinuous
            : from.type == urdf::Joint::PRISMATIC  ? JointType::kPrismatic
            : from.type == urdf::Joint::FLOATING   ? JointType::kFloating
                                                   : JointType::kFixed;
  to.parent_link = parent_link;
  to.child_link = child_link;
  to.X_PJ = toPose(from.parent_to_joint_origin_transform);
  if (!to.moves()) return to;
  to.axis = Eigen::Vector3d(from.axis.x, from.axis.y, from.axis.z).normalized();
  if (from.limits) {
    to.limits.has_position = to.type != JointType::kContinuous;
    to.limits.has_effort = to.limits.has_velocity = true;
    to.limits.lower = from.limits->lower;
    to.limits.upper = from.limits->upper;
    to.limits.effort = from.limits->effort;
    to.limits.velocity = from.limits->velocity;
  }
  if (from.safety) {
    to.soft.present = true;
    to.soft.k_position = from.safety->k_position;
    to.soft.k_velocity = from.safety->k_velocity;
    to.soft.lower = from.safety->soft_lower_limit;
    to.soft.upper = from.safety->soft_upper_limit;
  }
  if (from.dynamics) {
    to.damping = from.dynamics->damping;
    to.friction = from.dynamics->friction;
  }
  return to;
}

/** Appends a link and all that hangs from it, parents first, children by name of their joint. */
void appendTree(const urdf::Link& link, int parent_joint, RobotModel& model) {
  const int index = static_cast<int>(model.links.size());
  model.links.push_back(toLink(link, parent_joint));
  auto joints = link.child_joints;
  std::sort(joints.begin(), joints.end(), [](const auto& a, const auto& b) { return a->name < b->name; });
  for (const auto& joint : joints) {
    const int joint_index = static_cast<int>(model.joints.size());
    model.joints.push_back(toJoint(*joint, index, static_cast<int>(model.links.size())));
    for (const auto& child : link.child_links) {
      if (child->name == joint->child_link_name) appendTree(*child, joint_index, model);
    }
  }
}

void nameMovingJoints(RobotModel& model) {
  for (std::size_t i = 0; i < model.joints.size(); ++i) {
    if (model.joints[i].moves()) model.moving_joints.push_back(static_cast<int>(i));
  }
  std::sort(model.moving_joints.begin(), model.moving_joints.end(),
            [&](int a, int b) { return model.joints[a].name < model.joints[b].name; });
  for (int joint : model.moving_joints) {
    model.joints[joint].index = model.dofs();
    model.joint_names.push_back(model.joints[joint].name);
  }
}

/** urdfdom reads with a parser of its own. @throws ModelError  it read the name of a link or joint otherwise */
void requireSameNames(const UrdfSource& source, const tinyxml2::XMLElement& robot, const urdf::ModelInterface& parsed) {
  for (const auto* element = robot.FirstChildElement(); element; element = element->NextSiblingElement()) {
    const std::string kind = element->Name();
    if (kind != "link" && kind != "joint") continue;
    const std::string name = element->Attribute("name");
    if (kind == "link" ? bool(parsed.getLink(name)) : bool(parsed.getJoint(name))) continue;
    source.fail(*element, kind + " '" + name + "': found a name that urdfdom reads otherwise, must be plain text");
  }
}

}  // namespace

RobotModel loadRobotModel(const std::string& urdf_xml, const std::string& source_name) {
  if (urdf_xml.size() > kMostUrdfBytes) {
    throw ModelError(source_name + ": found " + std::to_string(urdf_xml.size()) +
                     " bytes, allowed <= " + std::to_string(kMostUrdfBytes));
  }
  RobotModel model;
  model.source_name = source_name;
  tinyxml2::XMLDocument document;
  if (document.Parse(urdf_xml.data(), urdf_xml.size()) != tinyxml2::XML_SUCCESS) {
    throw ModelError(source_name + ":" + std::to_string(document.ErrorLineNum()) + ": malformed XML: found " +
                     document.ErrorName() + ", must be well formed");
  }
  const tinyxml2::XMLElement* robot = document.FirstChildElement("robot");
  if (!robot) throw ModelError(source_name + ": found no <robot> element, must be the root of the document");
  const UrdfSource source{source_name, &model.warnings};
  checkUrdf(source, *robot);

  urdf::ModelInterfaceSharedPtr parsed;
  std::vector<std::string> messages;
  {
    MessageCapture capture;
    parsed = urdf::parseURDF(urdf_xml);
    messages = capture.messages;
  }
  if (!parsed || !parsed->getRoot()) {
    std::string text = source_name + ": found a URDF that urdfdom refuses, must be valid:";
    for (const auto& message : messages) text += " " + message;
    throw ModelError(text);
  }
  for (const auto& message : messages) model.warnings.push_back(source_name + ": " + message);
  requireSameNames(source, *robot, *parsed);
  model.name = parsed->getName();
  appendTree(*parsed->getRoot(), -1, model);
  nameMovingJoints(model);
  readMimics(source, *robot, model);
  readStribeck(source, *robot, model);
  for (Joint& joint : model.joints) joint.enforced = joint.limits;
  readTransmissions(source, *robot, model);
  readGazeboTags(source, *robot, model);
  return model;
}

RobotModel loadRobotModelFile(const std::string& path) {
  std::string text;
  try {
    text = aras_visual_servo_common::readFile(path, kMostUrdfBytes);
  } catch (const ArasError& error) {
    throw ModelError("URDF " + std::string(error.what()));
  }
  return loadRobotModel(text, path);
}

}  // namespace aras_visual_servo_sim
