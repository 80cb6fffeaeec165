#pragma once

#include <yaml-cpp/yaml.h>

#include <string>
#include <vector>

#include "aras_visual_servo_sim/config/package_paths.hpp"
#include "aras_visual_servo_sim/robot/robot_model.hpp"
#include "aras_visual_servo_sim/scene/scene.hpp"

namespace aras_visual_servo_sim {

/** Reads a target file: {name, color_rgb, outlines_m: [[[x, y], ...], ...], board: {size_m, color_rgb},
 *  image: {file, size_m}}, of the last three at least one. A plain image file is relative to the target file.
 *  @throws ModelError if a file is missing or not readable, ParameterError listing the faults of its contents */
PlanarModel loadPlanarModel(const std::string& path, const PackagePaths& packages = PackagePaths());
/** The same from a node. @param source_name  for messages @param base_dir  what a plain image file is relative to */
PlanarModel planarModelFromYaml(const YAML::Node& node, const std::string& source_name,
                                const PackagePaths& packages = PackagePaths(), const std::string& base_dir = "");

/** Reads the `scene:` section of a scenario:
 *  {background_rgb, light_direction, models: [...], solids: [...]}, of
 *  models {name, file or any of outlines_m, color_rgb, board, image, position_m, rpy_rad, motion, visible} and
 *  solids {name, box_m: [x, y, z] | cylinder_m: [radius, length] | sphere_m: radius | mesh: file |
 *  urdf: file or document, color_rgb, position_m, rpy_rad, motion}.
 *
 *  A null node gives an empty scene. @throws ParameterError, ModelError */
Scene loadScene(const YAML::Node& node, const PackagePaths& packages);

/** A scene of one model: an entry of `models` or of `solids`. @throws ParameterError, ModelError */
Scene loadSceneEntry(const YAML::Node& entry, const PackagePaths& packages);

/** The entry of a model that somebody describes in one text: a URDF document of fixed links, the name of a file
 *  (.urdf; .yaml: a flat target; else a mesh), or the entry itself as YAML.
 *  @throws ParameterError if it is none of these */
YAML::Node modelEntry(const std::string& name, const std::string& description);

/** All links of a URDF as one solid, its root link's frame that of the body.
 *  @param urdf  the document, or the name of a file @throws ModelError, also for joints that move */
Body bodyFromUrdf(const std::string& name, const std::string& urdf, const PackagePaths& packages);

/** The <collision> shapes of all its links, in the frame of the root link. @throws as bodyFromUrdf */
std::vector<Collision> collisionsFromUrdf(const std::string& name, const std::string& urdf,
                                          const PackagePaths& packages);

/** Adds one body for each link of the robot that has visuals, named as the link. @throws ModelError */
void addRobotBodies(const RobotModel& robot, const PackagePaths& packages, Scene& scene);

}  // namespace aras_visual_servo_sim
