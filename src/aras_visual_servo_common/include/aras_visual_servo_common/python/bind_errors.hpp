#pragma once

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include "aras_visual_servo_common/errors.hpp"

namespace aras_visual_servo_common {

/** Raises the class of this name of the Python module aras_visual_servo_common. */
inline void raisePython(const char* name, const pybind11::object& argument) {
  const pybind11::object errors = pybind11::module_::import("aras_visual_servo_common");
  PyErr_SetObject(pybind11::object(errors.attr(name)).ptr(), argument.ptr());
}

/** Makes a Python module raise our errors as the classes of the Python module aras_visual_servo_common, and gives it
 *  their names. The translator is local to the module: each module knows the C++ classes of its own libraries. */
inline void bindErrors(pybind11::module_& module) {
  namespace py = pybind11;
  const py::module_ errors = py::module_::import("aras_visual_servo_common");
  for (const py::handle name : errors.attr("__all__")) module.attr(name) = errors.attr(name);
  py::register_local_exception_translator([](std::exception_ptr pointer) {
    try {
      if (pointer) std::rethrow_exception(pointer);
    } catch (const ParameterError& error) {
      raisePython("ParameterError", py::cast(error.faults()));
    } catch (const ArasError& error) {
      const char* name = dynamic_cast<const ModelError*>(&error)          ? "ModelError"
                         : dynamic_cast<const ShapeError*>(&error)        ? "ShapeError"
                         : dynamic_cast<const NotFiniteError*>(&error)    ? "NotFiniteError"
                         : dynamic_cast<const UnknownNameError*>(&error)  ? "UnknownNameError"
                         : dynamic_cast<const StateError*>(&error)        ? "StateError"
                         : dynamic_cast<const RenderError*>(&error)       ? "RenderError"
                         : dynamic_cast<const DegenerateFeature*>(&error) ? "DegenerateFeature"
                                                                          : "ArasError";
      raisePython(name, py::str(error.what()));
    }
  });
}

}  // namespace aras_visual_servo_common
