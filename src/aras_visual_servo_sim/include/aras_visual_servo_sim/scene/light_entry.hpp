#pragma once

#include <yaml-cpp/yaml.h>

#include <string>
#include <vector>

#include "aras_visual_servo_sim/scene/lighting.hpp"

namespace aras_visual_servo_sim {

/** A light from an entry of `lights` of the section `scene/lighting`. @throws ParameterError listing every fault */
Light lightFromYaml(const YAML::Node& node);
/** The entry that describes a light. */
YAML::Node lightYaml(const Light& light);

/** A light from the text of one `<light>` of SDF, as a world, a link or a `<gazebo>` tag of a URDF has it, with SDF's
 *  own defaults. Its pose and direction are those of the frame that the element stands in.
 *  @param source    of the text, for messages
 *  @param warnings  given a line for what is ignored; may be null
 *  @throws ModelError naming the element: no name, an unknown type, no direction, numbers that are none */
Light lightFromSdf(const std::string& xml, const std::string& source, std::vector<std::string>* warnings = nullptr);

/** Either of the two: a text that begins with `<` is SDF, any other is YAML. @throws as they do */
Light lightFromText(const std::string& text);

}  // namespace aras_visual_servo_sim
