#include "aras_visual_servo_sim/config/section.hpp"

#include <aras_visual_servo_common/yaml_value.hpp>
#include <cmath>

#include "aras_visual_servo_sim/config/errors.hpp"

namespace aras_visual_servo_sim {

using aras_visual_servo_common::exactNumber;

void checkValue(const Schema& section, const std::string& key, const YAML::Node& value, FaultList& faults) {
  section.property(YAML::Node(), key)->check(value, key, faults);
}

void checkValue(const Schema& section, const std::string& key, double value, FaultList& faults) {
  checkValue(section, key, exactNumber(value), faults);
}

void checkValue(const Schema& section, const std::string& key, const std::string& value, FaultList& faults) {
  checkValue(section, key, aras_visual_servo_common::quotedText(value), faults);
}

void checkValue(const Schema& section, const std::string& key, const std::vector<double>& values, FaultList& faults) {
  YAML::Node list(YAML::NodeType::Sequence);
  for (const double value : values) list.push_back(exactNumber(value));
  checkValue(section, key, list, faults);
}

void checkPlace(const std::string& what, const Pose& pose) {
  constexpr double kLeastLength = 1e-9;
  static const auto kAllowed = sectionOf("solid").properties.at("position_m")->items->range;
  if (!pose.p.allFinite() || !pose.q.coeffs().allFinite()) throw NotFiniteError(what + ": pose is not finite");
  const double length = pose.q.norm();
  if (!(length >= kLeastLength) || !std::isfinite(length)) {
    throw ParameterError(what + ": found a quaternion of the length " + std::to_string(length) +
                         ", allowed one that can be made 1");
  }
  for (const double value : pose.p) {
    if (kAllowed.contains(value)) continue;
    throw ParameterError(what + ": found a position of " + std::to_string(value) + " m, allowed " + kAllowed.text());
  }
}

}  // namespace aras_visual_servo_sim
