#pragma once

#include <yaml-cpp/yaml.h>

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "aras_visual_servo_sim/config/section.hpp"
#include "aras_visual_servo_sim/config/types.hpp"
#include "aras_visual_servo_sim/robot/robot_model.hpp"

namespace aras_visual_servo_sim {

/** A solid that is not a link of the robot. It stays at rest, or moves freely if it has mass. */
struct Obstacle {
  std::string name;
  Geometry geometry;
  Pose X_WO;             ///< at the start
  double mass_kg = 0.0;  ///< 0: it stays where it is; else spread evenly, a mesh's over its bounding box
  Pose X_OG{};           ///< of the geometry; identity if it has mass. Obstacles of one name are parts of one solid
};

/** Which bodies touch each other, and how stiffly. By default none do, and no collision shape is built. */
struct ContactConfig {
  /** By default no contacts. */
  ContactConfig(const ContactsConfig& settings = ContactsConfig());

  /** Names of links and obstacles; `robot` stands for every link, in either place. */
  std::vector<std::pair<std::string, std::string>> pairs;
  std::optional<GroundPlane> ground;
  bool neighbours;  ///< whether links and obstacles touch those of other robots of the worldGroup
  double friction;  ///< Coulomb's coefficient of the pairs
  std::map<std::string, double> frictions;    ///< of links and solids by name; the smallest of a contact counts
  double stiffness_n_per_m;                   ///< normal force per depth at each point of contact
  double damping_n_s_per_m;                   ///< normal force per speed of approach
  std::map<std::string, double> free_bodies;  ///< solid: mass [kg]
  std::vector<Obstacle> obstacles;            ///< the solids of the scene, filled in by Contacts (simulation)
  /** Points of the mesh files that collision shapes name, unscaled [m]; their convex hull is what touches. */
  std::map<std::string, std::vector<Eigen::Vector3d>> mesh_points;
  std::set<std::string> hollow_meshes;  ///< files whose hull is not touched where the base is driven, as of a house

  bool any() const { return pushes() || neighbours; }
  /** Whether the robot touches anything besides other robots. */
  bool pushes() const { return ground || !pairs.empty(); }
};

/** Reads section `contacts`. Null: none. @throws ParameterError listing every fault */
ContactConfig contactConfigFromYaml(const YAML::Node& node);

/** Whether a closed mesh fills less than 0.9 of its convex hull, so that the hull cannot stand for it. */
bool isHollow(const std::vector<Eigen::Vector3d>& points, const std::vector<std::array<std::uint32_t, 3>>& triangles);

}  // namespace aras_visual_servo_sim
