#include "yaml_from_python.hpp"

#include <cmath>

#include "aras_visual_servo_sim/config/errors.hpp"

namespace py = pybind11;

namespace aras_visual_servo_sim {
namespace {

YAML::Node textNode(const std::string& text) {
  YAML::Node node(text);
  node.SetTag("!");  // what yaml-cpp gives a quoted scalar
  return node;
}

std::string numberText(const py::handle& value) {
  if (py::isinstance<py::float_>(value)) {
    const double number = value.cast<double>();
    if (std::isnan(number)) return ".nan";
    if (std::isinf(number)) return number > 0.0 ? ".inf" : "-.inf";
  }
  return py::repr(value).cast<std::string>();  // Python's repr of a float is exact
}

}  // namespace

YAML::Node yamlFromPython(const py::handle& value, const std::string& where) {
  if (value.is_none()) return YAML::Node();
  if (py::isinstance<py::bool_>(value)) return YAML::Node(value.cast<bool>() ? "true" : "false");
  if (py::isinstance<py::float_>(value) && !py::hasattr(value, "tolist")) return YAML::Node(numberText(value));
  if (py::isinstance<py::int_>(value)) return YAML::Node(numberText(value));
  if (py::isinstance<py::str>(value)) return textNode(value.cast<std::string>());
  if (py::isinstance<py::dict>(value)) {
    YAML::Node node(YAML::NodeType::Map);
    for (const auto& [key, member] : value.cast<py::dict>()) {
      const std::string name = py::str(key);
      node[name] = yamlFromPython(member, where + "/" + name);
    }
    return node;
  }
  if (py::isinstance<py::list>(value) || py::isinstance<py::tuple>(value)) {
    YAML::Node node(YAML::NodeType::Sequence);
    for (const auto& member : value) node.push_back(yamlFromPython(member, where + "[]"));
    return node;
  }
  if (py::hasattr(value, "tolist")) return yamlFromPython(value.attr("tolist")(), where);  // numpy
  const std::string type = py::str(py::type::of(value));
  throw ParameterError(where + ": found " + type + ", allowed a dict, list, number, string, bool or None");
}

}  // namespace aras_visual_servo_sim
