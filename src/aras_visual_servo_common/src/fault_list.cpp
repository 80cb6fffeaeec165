#include "aras_visual_servo_common/fault_list.hpp"

#include <algorithm>
#include <sstream>

#include "aras_visual_servo_common/text.hpp"

namespace aras_visual_servo_common {
namespace {

constexpr std::size_t kMost = 200;  // lines; more are not read, and a hostile file could ask for a million

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
  if (lines_.size() > kMost || std::find(lines_.begin(), lines_.end(), line) != lines_.end()) return;
  lines_.push_back(lines_.size() < kMost ? line : "found more than " + std::to_string(kMost) + " faults, allowed none");
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
