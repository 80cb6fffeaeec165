#pragma once

#include <string>
#include <vector>

namespace aras_visual_servo_common {

/** The words in one text, a separator between each two. */
std::string joined(const std::vector<std::string>& words, const std::string& separator = ", ");

/** "; did you mean NAME?" of the name that a misspelt one is nearest to; empty if none is near. */
std::string didYouMean(const std::string& found, const std::vector<std::string>& names);

/** What is allowed where a name is one of several: all of them if they are few, and the nearest one. */
std::string oneOf(const std::vector<std::string>& names, const std::string& found);

/** The number in up to 12 digits, without trailing zeros. */
std::string numberText(double value);

}  // namespace aras_visual_servo_common
