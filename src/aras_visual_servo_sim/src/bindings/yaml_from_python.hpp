#pragma once

#include <pybind11/pybind11.h>
#include <yaml-cpp/yaml.h>

#include <string>

namespace aras_visual_servo_sim {

/** Nested dicts, lists, tuples, numbers, strings, bools, None and numpy scalars or arrays as YAML. Strings stay strings
 *  ("1" does not become 1), numbers keep every bit.
 *  @param where  name of the value in messages
 *  @throws ParameterError naming the place of anything else */
YAML::Node yamlFromPython(const pybind11::handle& value, const std::string& where);

}  // namespace aras_visual_servo_sim
