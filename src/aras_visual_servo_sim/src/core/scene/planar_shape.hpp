#pragma once

#include <string>

#include "aras_visual_servo_sim/config/package_paths.hpp"
#include "aras_visual_servo_sim/config/section.hpp"
#include "aras_visual_servo_sim/scene/scene_config.hpp"

namespace aras_visual_servo_sim {

/** Of red, green and blue, 0 .. 255, rounded to bytes. */
Rgb colorOf(const Eigen::Vector3d& rgb);
/** A colour of three numbers, section `color`. */
Rgb readColor(YamlReader& reader, const std::string& key);

/** The keys that describe what a flat model looks like. Faults go to reader, whose owner calls finish(). */
PlanarShape readPlanarShape(YamlReader& reader);

/** The model of such a shape, its picture loaded. @param base_dir  what a plain name of a picture is relative to
 *  @throws ModelError */
PlanarModel planarModelOf(const std::string& name, const PlanarShape& shape, const PackagePaths& packages,
                          const std::string& base_dir = "");

}  // namespace aras_visual_servo_sim
