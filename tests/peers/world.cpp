// What the simulator's physics makes of given states: asked by the tests beside Pinocchio and MuJoCo, which live in a
// Python of their own.
//
// Reads from standard input a YAML (or JSON) map:
//   urdf: the document   gravity: (3,) [m/s^2]   period_s   floating: the root link is free
//   ground: {z_m, friction}, or none   actuated: every joint takes an effort
//   cases: [{q: {joint: position}, v: {joint: velocity}, effort: {joint: effort}, steps: n,
//            pose: (12,) rows of X_WB, twist: (6,) V_WB_W}]
// Writes a JSON list, one object per case: mass_matrix and, per link, pose (12,) and twist V_WL_L (6,), of the state as
// given; after the steps q, v, base_pose, base_twist and force, the sum of what contacts do in W.
// Vectors of joints are sorted by name; a mass matrix of a free body has its six behind them.
#include <yaml-cpp/yaml.h>

#include <cstdio>
#include <exception>
#include <iostream>
#include <iterator>
#include <string>
#include <vector>

#include "aras_visual_servo_sim/physics/multibody_world.hpp"
#include "aras_visual_servo_sim/robot/urdf_loader.hpp"

namespace {

using namespace aras_visual_servo_sim;  // NOLINT

void print(const char* name, const double* values, std::size_t count, const char* after) {
  std::printf("\"%s\": [", name);
  for (std::size_t i = 0; i < count; ++i) std::printf("%s%.17g", i ? ", " : "", values[i]);
  std::printf("]%s", after);
}

void printPose(const char* name, const Pose& X, const char* after) {
  const Eigen::Matrix<double, 4, 4, Eigen::RowMajor> rows = X.matrix();
  print(name, rows.data(), 12, after);
}

Eigen::VectorXd numbers(const YAML::Node& list) {
  const auto values = list.as<std::vector<double>>();
  return Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
}

Eigen::VectorXd byName(const YAML::Node& map, const RobotModel& model) {
  Eigen::VectorXd values = Eigen::VectorXd::Zero(model.dofs());
  if (map)
    for (const auto& entry : map) values[model.jointIndex(entry.first.as<std::string>())] = entry.second.as<double>();
  return values;
}

WorldConfig configOf(const YAML::Node& asked, const RobotModel& model) {
  WorldConfig config;
  config.period_s = asked["period_s"].as<double>();
  config.gravity_m_s2 = numbers(asked["gravity"]);
  config.base = asked["floating"].as<bool>() ? Base::kFloating : Base::kFixed;
  if (const YAML::Node ground = asked["ground"])
    config.contacts.ground = GroundPlane{ground["z_m"].as<double>(), ground["friction"].as<double>()};
  if (asked["actuated"].as<bool>())
    for (const std::string& joint : model.joint_names) {
      ControllerConfig controller;
      controller.name = joint + "_controller";
      controller.type = ControllerType::kEffort;
      controller.joint = joint;
      config.controllers.push_back(controller);
    }
  return config;
}

void answer(MultibodyWorld& world, const YAML::Node& c) {
  const RobotModel& model = world.model();
  world.reset(byName(c["q"], model));
  world.setJointVelocities(byName(c["v"], model));
  if (c["pose"]) {
    const Eigen::VectorXd rows = numbers(c["pose"]);
    const Eigen::Map<const Eigen::Matrix<double, 3, 4, Eigen::RowMajor>> X(rows.data());
    world.setBasePose(Pose{X.col(3), Eigen::Quaterniond(Eigen::Matrix3d(X.leftCols<3>()))});
    world.setBaseTwist(numbers(c["twist"]));
  }
  std::printf("{");
  const Eigen::MatrixXd M = world.massMatrix();
  print("mass_matrix", M.data(), static_cast<std::size_t>(M.size()), ",\n \"links\": {");
  for (std::size_t k = 0; k < model.links.size(); ++k) {
    std::printf("%s\"%s\": {", k ? ", " : "", model.links[k].name.c_str());
    printPose("pose", world.linkPose(static_cast<int>(k)), ", ");
    print("twist", world.linkTwist(static_cast<int>(k)).data(), 6, "}");
  }
  std::printf("},\n ");
  if (c["effort"])
    for (const auto& entry : c["effort"]) world.setEffort(entry.first.as<std::string>(), entry.second.as<double>());
  world.step(c["steps"].as<int>());
  print("q", world.jointPositions().data(), static_cast<std::size_t>(model.dofs()), ", ");
  print("v", world.jointVelocities().data(), static_cast<std::size_t>(model.dofs()), ", ");
  if (world.floatingBase()) {
    // The root link has no twist of its own in W but through the link: turned from L into W.
    const Twist V_L = world.linkTwist(0);
    const Pose X_WB = world.basePose();
    Twist V_W;
    V_W << X_WB.q * V_L.head<3>(), X_WB.q * V_L.tail<3>();
    printPose("base_pose", X_WB, ", ");
    print("base_twist", V_W.data(), 6, ", ");
  }
  Eigen::Vector3d force = Eigen::Vector3d::Zero();
  for (const ContactForce& contact : world.contacts())
    force += contact.force_W * (contact.a == "ground_plane" ? -1 : 1);
  print("force", force.data(), 3, "}");
}

}  // namespace

int main() try {
  const std::string text((std::istreambuf_iterator<char>(std::cin)), std::istreambuf_iterator<char>());
  const YAML::Node asked = YAML::Load(text), cases = asked["cases"];
  const RobotModel model = loadRobotModel(asked["urdf"].as<std::string>(), "peers.urdf");
  MultibodyWorld world(model, configOf(asked, model));
  std::printf("[");
  for (std::size_t k = 0; k < cases.size(); ++k) {
    if (k > 0) std::printf(",\n");
    answer(world, cases[k]);
  }
  std::printf("]\n");
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "sim_world: %s\n", error.what());
  return 1;
}
