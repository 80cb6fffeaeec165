#pragma once

#include <yaml-cpp/yaml.h>

#include <Eigen/Core>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "aras_visual_servo_sim/config/section.hpp"
#include "aras_visual_servo_sim/config/types.hpp"
#include "aras_visual_servo_sim/robot/robot_model.hpp"

namespace aras_visual_servo_sim {

/** Something solid that is no link of the robot: at rest, or free to move when it has mass. */
struct Obstacle {
  std::string name;
  Geometry geometry;
  Pose X_WO;             ///< at the start
  double mass_kg = 0.0;  ///< 0: it stays where it is put; else uniform, a mesh as its bounding box
  Pose X_OG{};           ///< of the geometry; identity if it has mass. Obstacles of one name are one thing, at one pose
};

/** The plane z = z_m, solid below. */
struct GroundPlane {
  double z_m, friction;
};

/** What touches what, and how hard. Nothing by default: then no shape is even built. */
struct ContactConfig {
  /** Nothing, with the defaults of section `contacts`. */
  ContactConfig();

  /** Names of links and obstacles; `robot` stands for every link, in either place. */
  std::vector<std::pair<std::string, std::string>> pairs;
  std::optional<GroundPlane> ground;
  double friction;                            ///< Coulomb's coefficient of the pairs
  double stiffness_n_per_m;                   ///< normal force per depth at each point of contact
  double damping_n_s_per_m;                   ///< normal force per speed of approach
  std::map<std::string, double> free_bodies;  ///< solid: mass [kg]
  std::vector<Obstacle> obstacles;            ///< the solids of the scene, filled in by whoever knows it
  /** Points of the mesh files that collision shapes name, unscaled [m]; their convex hull is what touches. */
  std::map<std::string, std::vector<Eigen::Vector3d>> mesh_points;

  bool any() const { return ground || !pairs.empty(); }
};

/** Reads section `contacts`. Null: none. @throws ParameterError listing every fault */
ContactConfig contactConfigFromYaml(const YAML::Node& node);
/** The same as part of a larger reading: faults go to reader, whose owner calls finish(). */
ContactConfig readContacts(YamlReader reader);

}  // namespace aras_visual_servo_sim
