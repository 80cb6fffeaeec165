#pragma once

#include <yaml-cpp/yaml.h>

#include <string>
#include <vector>

#include "aras_visual_servo_sim/config/package_paths.hpp"
#include "aras_visual_servo_sim/robot/robot_model.hpp"
#include "aras_visual_servo_sim/scene/scene.hpp"
#include "aras_visual_servo_sim/scene/scene_config.hpp"

namespace aras_visual_servo_sim {

/** Reads a target file: {name, color_rgb, outlines_m: [[[x, y], ...], ...], board: {size_m, color_rgb},
 *  image: {file, size_m}}, of the last three at least one. A plain image file is relative to the target file.
 *  @throws ModelError if a file is missing or not readable, ParameterError listing the faults of its contents */
PlanarModel loadPlanarModel(const std::string& path, const PackagePaths& packages = PackagePaths());
/** The same from a node. @param source_name  for messages @param base_dir  what a plain image file is relative to */
PlanarModel planarModelFromYaml(const YAML::Node& node, const std::string& source_name,
                                const PackagePaths& packages = PackagePaths(), const std::string& base_dir = "");

/** Makes the scene of a configuration: reads the files it names. @throws ModelError, ParameterError */
Scene loadScene(const SceneConfig& config, const PackagePaths& packages);

/** Adds one entry to a scene, after those that it has. @throws ModelError, ParameterError; nothing is added then */
void loadSceneEntry(const SceneEntry& entry, const PackagePaths& packages, Scene& scene);

/** The collision shapes of a solid, in its frame. @throws ModelError for a URDF that cannot be used */
std::vector<Collision> collisionsOf(const SolidEntry& solid, const PackagePaths& packages);

/** All links of a URDF as one solid, its root link's frame that of the body.
 *  @param urdf    the document, or the name of a file
 *  @param lights  given those of its links, attached to the body and named NAME::LIGHT; may be null
 *  @throws ModelError, also for joints that move */
Body bodyFromUrdf(const std::string& name, const std::string& urdf, const PackagePaths& packages,
                  std::vector<Light>* lights = nullptr);

/** The <collision> shapes of all its links, in the frame of the root link. @throws as bodyFromUrdf */
std::vector<Collision> collisionsFromUrdf(const std::string& name, const std::string& urdf,
                                          const PackagePaths& packages);

/** Adds one body for each link of the robot that has visuals, named as the link, and the lights of its links.
 *  @param name  of the robot in its world, see scoped @throws ModelError */
void addRobotBodies(const RobotModel& robot, const PackagePaths& packages, Scene& scene, const std::string& name = "");

}  // namespace aras_visual_servo_sim
