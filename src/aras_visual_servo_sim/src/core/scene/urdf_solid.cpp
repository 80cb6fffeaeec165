// A URDF of fixed links as one solid.
#include <algorithm>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "aras_visual_servo_sim/robot/urdf_loader.hpp"
#include "aras_visual_servo_sim/scene/scene_loader.hpp"

namespace aras_visual_servo_sim {
namespace {

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

Body bodyFromUrdf(const std::string& name, const std::string& urdf, const PackagePaths& packages,
                  std::vector<Light>* lights) {
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
  for (Light light : parts.lighting.lights) {
    if (!lights) break;
    const Pose& X_BL = X_RL[static_cast<std::size_t>(robot.linkIndex(light.attached_to))];
    light.name = name + "::" + light.name;
    light.attached_to = name;
    light.position_A = X_BL * light.position_A;
    light.direction_A = X_BL.q * light.direction_A;
    lights->push_back(std::move(light));
  }
  const bool touchable =
      std::any_of(robot.links.begin(), robot.links.end(), [](const Link& link) { return !link.collisions.empty(); });
  if (body.shapes.empty() && !touchable) {
    throw ModelError("model '" + name + "': no link of its URDF has a <visual> or a <collision>");
  }
  return body;
}

}  // namespace aras_visual_servo_sim
