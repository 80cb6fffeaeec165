// Models that come one at a time.
#include "aras_visual_servo_sim/config/errors.hpp"
#include "aras_visual_servo_sim/robot/urdf_loader.hpp"
#include "aras_visual_servo_sim/scene/scene_loader.hpp"

namespace aras_visual_servo_sim {
namespace {

bool endsWith(const std::string& text, const std::string& suffix) {
  return text.size() >= suffix.size() && text.compare(text.size() - suffix.size(), suffix.size(), suffix) == 0;
}

/** X_RL of every link in the root's frame. @throws ModelError for a joint that moves */
std::vector<Pose> linkPoses(const RobotModel& robot, const std::string& name) {
  std::vector<Pose> poses;
  for (const Link& link : robot.links) {  // parents first
    if (link.parent_joint < 0) {
      poses.emplace_back();
      continue;
    }
    const Joint& joint = robot.joints[static_cast<std::size_t>(link.parent_joint)];
    if (joint.type != JointType::kFixed) {
      throw ModelError("model '" + name + "': joint '" + joint.name + "' of its URDF moves, allowed fixed joints");
    }
    poses.push_back(poses[static_cast<std::size_t>(joint.parent_link)] * joint.X_PJ);
  }
  return poses;
}

RobotModel loadUrdf(const std::string& name, const std::string& urdf, const PackagePaths& packages) {
  const bool is_document = urdf.find('<') != std::string::npos;
  return is_document ? loadRobotModel(urdf, "model '" + name + "'") : loadRobotModelFile(packages.resolve(urdf));
}

}  // namespace

std::vector<Collision> collisionsFromUrdf(const std::string& name, const std::string& urdf,
                                          const PackagePaths& packages) {
  const RobotModel robot = loadUrdf(name, urdf, packages);
  const std::vector<Pose> X_RL = linkPoses(robot, name);
  std::vector<Collision> collisions;
  for (std::size_t link = 0; link < robot.links.size(); ++link) {
    for (Collision collision : robot.links[link].collisions) {
      collision.X_link_collision = X_RL[link] * collision.X_link_collision;
      collisions.push_back(std::move(collision));
    }
  }
  return collisions;
}

Body bodyFromUrdf(const std::string& name, const std::string& urdf, const PackagePaths& packages) {
  const RobotModel robot = loadUrdf(name, urdf, packages);
  const std::vector<Pose> X_RL = linkPoses(robot, name);
  Scene parts;
  addRobotBodies(robot, packages, parts);
  Body body;
  body.name = name;
  for (const Body& part : parts.bodies) {
    const Pose& X_BL = X_RL[static_cast<std::size_t>(robot.linkIndex(part.name))];
    for (Shape shape : part.shapes) {
      shape.X_BS = X_BL * shape.X_BS;
      body.shapes.push_back(std::move(shape));
    }
  }
  if (body.shapes.empty()) throw ModelError("model '" + name + "': no link of its URDF has a <visual>");
  return body;
}

Scene loadSceneEntry(const YAML::Node& entry, const PackagePaths& packages) {
  bool solid = false;
  for (const char* key : {"box_m", "cylinder_m", "sphere_m", "mesh", "urdf"}) {
    solid = solid || (entry.IsMap() && entry[key].IsDefined());
  }
  YAML::Node scene;
  scene[solid ? "solids" : "models"].push_back(entry);
  return loadScene(scene, packages);
}

YAML::Node modelEntry(const std::string& name, const std::string& description) {
  const std::size_t first = description.find_first_not_of(" \t\r\n");
  if (first == std::string::npos) {
    throw ParameterError("model '" + name + "': found an empty description, allowed a URDF, a file name or YAML");
  }
  YAML::Node entry;
  const bool one_line = description.find('\n') == std::string::npos && description[first] != '{';
  if (description[first] == '<' || (one_line && endsWith(description, ".urdf"))) {
    entry["urdf"] = description;
  } else if (one_line && (endsWith(description, ".yaml") || endsWith(description, ".yml"))) {
    entry["file"] = description;
  } else if (one_line && description.find(':') == description.find("://")) {
    entry["mesh"] = description;
  } else {
    try {
      entry = YAML::Load(description);
    } catch (const YAML::Exception& error) {
      throw ParameterError("model '" + name + "': " + error.what());
    }
    if (!entry.IsMap()) {
      throw ParameterError("model '" + name + "': found '" + description + "', allowed a URDF, a file name or YAML");
    }
  }
  entry["name"] = name;
  return entry;
}

}  // namespace aras_visual_servo_sim
