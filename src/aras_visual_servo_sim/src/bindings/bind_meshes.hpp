#pragma once

#include <pybind11/pybind11.h>

namespace aras_visual_servo_sim {

/** mesh_triangles. */
void bindMeshes(pybind11::module_& module);

}  // namespace aras_visual_servo_sim
