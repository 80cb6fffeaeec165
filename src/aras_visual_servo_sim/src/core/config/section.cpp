#include "aras_visual_servo_sim/config/section.hpp"

#include <aras_visual_servo_common/yaml_value.hpp>

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

}  // namespace aras_visual_servo_sim
