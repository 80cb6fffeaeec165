#include "aras_visual_servo_sim/config/section.hpp"

#include <aras_visual_servo_common/yaml_scalars.hpp>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "schema_sections.hpp"

namespace aras_visual_servo_sim {
namespace {

using aras_visual_servo_common::exactNumber;
using aras_visual_servo_common::YamlValue;

bool check(const Schema& section, const std::string& key, const YAML::Node& value, FaultList& faults) {
  const std::size_t before = faults.lines().size();
  section.property(YAML::Node(), key)->check(value, key, faults);
  return faults.lines().size() == before;
}

}  // namespace

const Schema& sectionOf(const std::string& name) { return schemaSections().section(name); }

template <typename T>
T defaultOf(const std::string& section, const std::string& key) {
  const auto described = sectionOf(section).property(YAML::Node(), key);
  if (described && described->default_value && YamlValue<T>::fits(*described)) {
    if (const auto value = YamlValue<T>::read(*described->default_value)) return *value;
  }
  throw aras_visual_servo_common::SchemaError("schema " + section + "/" + key +
                                              ": has no default of the type asked for");
}

template double defaultOf<double>(const std::string&, const std::string&);
template int defaultOf<int>(const std::string&, const std::string&);
template bool defaultOf<bool>(const std::string&, const std::string&);
template std::string defaultOf<std::string>(const std::string&, const std::string&);
template std::vector<double> defaultOf<std::vector<double>>(const std::string&, const std::string&);
template Eigen::Vector3d defaultOf<Eigen::Vector3d>(const std::string&, const std::string&);

bool checkValue(const Schema& section, const std::string& key, double value, FaultList& faults) {
  return check(section, key, exactNumber(value), faults);
}

bool checkValue(const Schema& section, const std::string& key, int value, FaultList& faults) {
  return check(section, key, YAML::Node(std::to_string(value)), faults);
}

bool checkValue(const Schema& section, const std::string& key, const std::string& value, FaultList& faults) {
  return check(section, key, aras_visual_servo_common::quotedText(value), faults);
}

bool checkValue(const Schema& section, const std::string& key, const std::vector<double>& values, FaultList& faults) {
  YAML::Node list(YAML::NodeType::Sequence);
  for (const double value : values) list.push_back(exactNumber(value));
  return check(section, key, list, faults);
}

}  // namespace aras_visual_servo_sim
