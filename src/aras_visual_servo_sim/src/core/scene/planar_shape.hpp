#pragma once

#include <string>

#include "aras_visual_servo_sim/config/package_paths.hpp"
#include "aras_visual_servo_sim/config/section.hpp"
#include "aras_visual_servo_sim/scene/scene_config.hpp"
#include "scene/light/color_reader.hpp"

namespace aras_visual_servo_sim {

/** The keys that describe what a flat model looks like. Faults go to reader, whose owner calls finish(). */
PlanarShape readPlanarShape(YamlReader& reader);

/** The model of such a shape, its picture loaded. @param base_dir  what a plain name of a picture is relative to
 *  @throws ModelError */
PlanarModel planarModelOf(const std::string& name, const PlanarShape& shape, const PackagePaths& packages,
                          const std::string& base_dir = "");

}  // namespace aras_visual_servo_sim
