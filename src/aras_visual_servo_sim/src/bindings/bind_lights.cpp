#include <string>

#include "aras_visual_servo_sim/scene/light_entry.hpp"
#include "bindings.hpp"

namespace aras_visual_servo_sim {
namespace {

py::object valueOf(const YAML::Node& node) {
  if (node.IsSequence()) {
    py::list values;
    for (const YAML::Node& each : node) values.append(each.as<double>());
    return values;
  }
  bool flag = false;
  double number = 0.0;
  if (YAML::convert<bool>::decode(node, flag)) return py::bool_(flag);
  if (YAML::convert<double>::decode(node, number)) return py::float_(number);
  return py::str(node.Scalar());
}

py::dict entryOf(const Light& light) {
  py::dict entry;
  for (const auto& key : lightYaml(light)) {
    const auto name = key.first.as<std::string>();
    const bool is_text = name == "name" || name == "type" || name == "attached_to";
    entry[py::str(name)] = is_text ? py::object(py::str(key.second.Scalar())) : valueOf(key.second);
  }
  return entry;
}

py::dict lights(const World& world) {
  py::dict all;
  for (const Light& light : world.lights()) all[py::str(light.name)] = entryOf(light);
  return all;
}

void setLight(World& world, const py::object& light) {
  if (py::isinstance<py::str>(light)) {
    world.setLight(lightFromText(light.cast<std::string>()));
  } else {
    world.setLight(lightFromYaml(yamlFromPython(light, "light")));
  }
}

}  // namespace

void bindLights(py::module_& module, WorldClass& type) {
  type.def_property_readonly("lights", &lights,
                             "dict of name -> dict as sim.scene.lighting.lights[] of a scenario, of the lights there "
                             "are.")
      .def("set_light", &setLight, py::arg("light"),
           "Adds a light, or changes the one of its name, until the next reset.\n\nArgs:\n"
           "    light: dict as sim.scene.lighting.lights[] of a scenario, see the README; or str, a <light> of SDF.\n"
           "Raises:\n    ParameterError (also: attached to what is not there, too many), ModelError; nothing changes "
           "then.")
      .def("delete_light", &World::deleteLight, py::arg("name"),
           "Removes a light; one of the configuration is back after a reset.\n\nRaises:\n    UnknownNameError.");
  module.def(
      "light_entry", [](const std::string& text) { return entryOf(lightFromText(text)); }, py::arg("text"),
      "The dict, as sim.scene.lighting.lights[] of a scenario, of a light that a <light> of SDF describes, or YAML.\n\n"
      "Raises:\n    ModelError, ParameterError.");
}

}  // namespace aras_visual_servo_sim
