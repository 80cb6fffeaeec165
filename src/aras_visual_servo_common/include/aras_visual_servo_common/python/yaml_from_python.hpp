#pragma once

#include <pybind11/pybind11.h>
#include <yaml-cpp/yaml.h>

#include <string>

#include "aras_visual_servo_common/errors.hpp"
#include "aras_visual_servo_common/yaml_value.hpp"

namespace aras_visual_servo_common {

/** Nested dicts, lists, tuples, numbers, strings, bools, None and numpy scalars or arrays as YAML. Strings stay strings
 *  ("1" does not become 1), numbers keep every bit.
 *  @param where  name of the value in messages
 *  @throws ParameterError naming the place of anything else */
inline YAML::Node yamlFromPython(const pybind11::handle& value, const std::string& where) {
  namespace py = pybind11;
  if (value.is_none()) return YAML::Node();
  if (py::hasattr(value, "tolist")) return yamlFromPython(value.attr("tolist")(), where);  // numpy
  if (py::isinstance<py::bool_>(value)) return YAML::Node(value.cast<bool>() ? "true" : "false");
  if (py::isinstance<py::int_>(value)) return YAML::Node(py::repr(value).cast<std::string>());
  if (py::isinstance<py::float_>(value)) return exactNumber(value.cast<double>());
  if (py::isinstance<py::str>(value)) return quotedText(value.cast<std::string>());
  if (py::isinstance<py::dict>(value)) {
    YAML::Node node(YAML::NodeType::Map);
    for (const auto& [key, member] : value.cast<py::dict>()) {
      const std::string name = py::str(key);
      node.force_insert(name, yamlFromPython(member, where + "." + name));
    }
    return node;
  }
  if (py::isinstance<py::list>(value) || py::isinstance<py::tuple>(value)) {
    YAML::Node node(YAML::NodeType::Sequence);
    for (const auto& member : value) node.push_back(yamlFromPython(member, where + "[]"));
    return node;
  }
  const std::string type = py::str(py::type::of(value));
  throw ParameterError(where + ": found " + type + ", allowed a dict, list, number, string, bool or None");
}

}  // namespace aras_visual_servo_common
