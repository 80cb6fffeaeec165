#include <pybind11/pybind11.h>

#include "aras_visual_servo_sim/config/errors.hpp"
#include "bind_simulation.hpp"

namespace py = pybind11;

namespace aras_visual_servo_sim {
namespace {

void bindErrors(py::module_& module) {
  const auto base = py::register_exception<ArasError>(module, "ArasError", PyExc_RuntimeError);
  py::register_exception<ModelError>(module, "ModelError", base);
  py::register_exception<ParameterError>(module, "ParameterError", base);
  py::register_exception<NotFiniteError>(module, "NotFiniteError", base);
  py::register_exception<ShapeError>(module, "ShapeError", base);
  py::register_exception<UnknownNameError>(module, "UnknownNameError", base);
  py::register_exception<StateError>(module, "StateError", base);
  py::register_exception<RenderError>(module, "RenderError", base);
}

}  // namespace
}  // namespace aras_visual_servo_sim

PYBIND11_MODULE(_sim, module) {
  module.doc() = "Binding of the simulator core; use the package aras_visual_servo_sim.";
  aras_visual_servo_sim::bindErrors(module);
  aras_visual_servo_sim::bindSimulation(module);
}
