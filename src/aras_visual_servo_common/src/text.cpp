#include "aras_visual_servo_common/text.hpp"

#include <sstream>

namespace aras_visual_servo_common {

std::string joined(const std::vector<std::string>& words, const std::string& separator) {
  std::string text;
  for (std::size_t k = 0; k < words.size(); ++k) text += (k == 0 ? "" : separator) + words[k];
  return text;
}

std::string numberText(double value) {
  constexpr int kDigits = 12;  // 268435456 and 0.1 both read as they were written
  std::ostringstream out;
  out.precision(kDigits);
  out << value;
  return out.str();
}

}  // namespace aras_visual_servo_common
