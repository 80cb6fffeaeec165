#pragma once

#include <string>
#include <vector>

namespace aras_visual_servo_common {

/** The words in one text, a separator between each two. */
std::string joined(const std::vector<std::string>& words, const std::string& separator = ", ");

/** The number in up to 12 digits, without trailing zeros. */
std::string numberText(double value);

}  // namespace aras_visual_servo_common
