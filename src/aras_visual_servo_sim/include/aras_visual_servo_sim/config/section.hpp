#pragma once

#include <yaml-cpp/yaml.h>

#include <Eigen/Core>
#include <aras_visual_servo_common/fault_list.hpp>
#include <aras_visual_servo_common/schema.hpp>
#include <aras_visual_servo_common/yaml_reader.hpp>
#include <string>
#include <vector>

namespace aras_visual_servo_sim {

using aras_visual_servo_common::FaultList;
using aras_visual_servo_common::Schema;
using aras_visual_servo_common::YamlReader;

/** A section of this package's folder `schema`, the only place where types, ranges, choices and defaults of its keys
 *  stand. @param name  name of its file without .yaml @throws UnknownNameError */
const Schema& sectionOf(const std::string& name);

/** Default of a key, of a type T that YamlReader reads. @throws SchemaError if the key has no default of that type */
template <typename T>
T defaultOf(const std::string& section, const std::string& key);

/** Checks a value that does not come from YAML against what a section says about its key.
 *  @return true if the value is allowed; otherwise a fault is added and false returned */
bool checkValue(const Schema& section, const std::string& key, double value, FaultList& faults);
bool checkValue(const Schema& section, const std::string& key, int value, FaultList& faults);
bool checkValue(const Schema& section, const std::string& key, const std::string& value, FaultList& faults);
bool checkValue(const Schema& section, const std::string& key, const std::vector<double>& values, FaultList& faults);

}  // namespace aras_visual_servo_sim
