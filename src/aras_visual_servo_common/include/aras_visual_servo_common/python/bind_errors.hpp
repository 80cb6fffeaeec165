#pragma once

#include <pybind11/pybind11.h>

#include "aras_visual_servo_common/errors.hpp"

namespace aras_visual_servo_common {

/** The errors as Python exceptions of a module, ArasError their base, itself a RuntimeError. They are local to the
 * module: what the simulator throws stays the simulator's when the camera's module is loaded as well. */
inline void bindErrors(pybind11::module_& module) {
  namespace py = pybind11;
  const auto base = py::register_local_exception<ArasError>(module, "ArasError", PyExc_RuntimeError);
  // The one registered last is tried first: the leaves come after their base.
  py::register_local_exception<ParameterError>(module, "ParameterError", base);
  py::register_local_exception<SchemaError>(module, "SchemaError", base);
  py::register_local_exception<ModelError>(module, "ModelError", base);
  py::register_local_exception<ShapeError>(module, "ShapeError", base);
  py::register_local_exception<NotFiniteError>(module, "NotFiniteError", base);
  py::register_local_exception<UnknownNameError>(module, "UnknownNameError", base);
  py::register_local_exception<StateError>(module, "StateError", base);
  py::register_local_exception<RenderError>(module, "RenderError", base);
  py::register_local_exception<DegenerateFeature>(module, "DegenerateFeature", base);
}

}  // namespace aras_visual_servo_common
