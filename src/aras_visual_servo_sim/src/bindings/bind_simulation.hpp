#pragma once

#include <pybind11/pybind11.h>

namespace aras_visual_servo_sim {

/** Adds the class Simulation to a module. */
void bindSimulation(pybind11::module_& module);

}  // namespace aras_visual_servo_sim
