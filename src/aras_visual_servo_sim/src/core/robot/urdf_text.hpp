#pragma once

#include <tinyxml2.h>

#include <string>

#include "urdf_check.hpp"

namespace aras_visual_servo_sim {

/** Text of an element without the white space around it; empty for null. */
std::string textOf(const tinyxml2::XMLElement* element);

/** Text of a child element; empty when there is none. @param parent  may be null */
std::string childText(const tinyxml2::XMLElement* parent, const char* tag);

/** Number in the text of a child element, fallback when there is no such child. @param parent  may be null
 *  @throws ModelError naming file and line unless it is one finite number */
double childNumber(const UrdfSource& source, const tinyxml2::XMLElement* parent, const char* tag,
                   double fallback = 0.0);

/** Truth of a child element's text as sdformat reads it (true, 1, false, 0). @throws ModelError for anything else */
bool childFlag(const UrdfSource& source, const tinyxml2::XMLElement* parent, const char* tag, bool fallback);

}  // namespace aras_visual_servo_sim
