#pragma once

#include <pybind11/pybind11.h>

namespace aras_visual_servo_sim {

/** Shapes without a simulation: mesh_triangles, RayCaster. */
void bindShapes(pybind11::module_& module);

}  // namespace aras_visual_servo_sim
