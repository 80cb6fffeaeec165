#include "aras_visual_servo_common/fault_list.hpp"

#include <algorithm>
#include <sstream>

#include "aras_visual_servo_common/text.hpp"

namespace aras_visual_servo_common {
namespace {

std::vector<std::string> linesOf(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

}  // namespace

ParameterError::ParameterError(const std::string& text) : ArasError(text), faults_(linesOf(text)) {}

ParameterError::ParameterError(const std::vector<std::string>& faults)
    : ArasError(joined(faults, "\n")), faults_(faults) {}

void FaultList::add(const std::string& line) {
  if (std::find(lines_.begin(), lines_.end(), line) == lines_.end()) lines_.push_back(line);
}

void FaultList::add(const std::string& where, const std::string& found, const std::string& allowed) {
  add(where + ": found " + found + ", allowed " + allowed);
}

void FaultList::adopt(const ParameterError& error, const std::string& prefix) {
  for (const std::string& line : error.faults()) add(prefix + line);
}

void FaultList::throwIfAny() const {
  if (!lines_.empty()) throw ParameterError(lines_);
}

}  // namespace aras_visual_servo_common
