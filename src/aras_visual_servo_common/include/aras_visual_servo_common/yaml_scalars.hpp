#pragma once

#include <yaml-cpp/yaml.h>

#include <string>

namespace aras_visual_servo_common {

/** Text that is never taken for a number or a truth value, as if it stood in quotes. */
YAML::Node quotedText(const std::string& text);

/** A number with every bit; NaN and infinities as YAML writes them. */
YAML::Node exactNumber(double value);

}  // namespace aras_visual_servo_common
