#pragma once

#include <string>

#include "aras_visual_servo_sim/config/package_paths.hpp"
#include "aras_visual_servo_sim/config/yaml_reader.hpp"
#include "aras_visual_servo_sim/scene/scene_config.hpp"

namespace aras_visual_servo_sim {

/** A colour of three numbers, 0 .. 255. */
Rgb readColor(YamlReader& reader, const std::string& key, const Rgb& default_color);

/** color_rgb, outlines_m, board and image of a planar model. Faults go to reader, whose owner calls finish(). */
PlanarShape readPlanarShape(YamlReader& reader);

/** The model of such a shape, its picture loaded. @param base_dir  what a plain name of a picture is relative to
 *  @throws ModelError */
PlanarModel planarModelOf(const std::string& name, const PlanarShape& shape, const PackagePaths& packages,
                          const std::string& base_dir = "");

}  // namespace aras_visual_servo_sim
